// Variables over another variable: a panel for each, every run a curve, a dot at the time of the cursor.
mocc.Plane = class {
  constructor(root) {
    this.root = root;
    this.cursor = null;
    this.charts = [];
    new ResizeObserver(() => this.draw()).observe(root);
  }

  // `axis` is { name, scale } of the abscissa; panels are { label, scale, curves: [{ name, time, x, y, colour, dash }] } with
  // values in SI units, row by row.
  show(axis, panels) {
    const { html, svg } = mocc;
    this.root.replaceChildren();
    this.axis = axis;
    this.charts = panels.map((panel, k) => {
      const element = html('div', { class: 'panel' }, this.root);
      const header = html('header', {}, element);
      html('span', { class: 'axis' }, header, `${panel.label}${panel.scale.unit ? ` in ${panel.scale.unit}` : ''}`);
      const values = panel.curves.map(c => {
        const item = html('span', { class: 'curve' }, header);
        const key = svg('svg', { width: 20, height: 10, 'aria-hidden': 'true' }, item);
        this.stroke(c, 'M0 5H20', key);
        html('span', {}, item, c.name);
        return html('span', { class: 'value' }, item);
      });
      const plot = svg('svg', { role: 'img', 'aria-label': panel.label }, element);
      const chart = { panel, values, plot, k, view: null, mark: null };
      this.listen(chart);
      return chart;
    });
    this.draw();
  }

  stroke(c, path, parent) {
    const element = mocc.svg('path', { d: path, fill: 'none', 'stroke-width': 1.7, 'stroke-linejoin': 'round' }, parent);
    element.style.stroke = c.colour;
    if (c.dash) element.setAttribute('stroke-dasharray', c.dash);
    return element;
  }

  // A rectangle that is drawn is shown, a double click shows everything.
  listen(chart) {
    const { plot } = chart;
    const place = event => {
      const box = plot.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    let from = null;
    plot.addEventListener('pointerdown', event => {
      from = place(event);
      plot.setPointerCapture(event.pointerId);
    });
    plot.addEventListener('pointermove', event => {
      if (from === null) return;
      chart.mark = [from, place(event)];
      this.draw();
    });
    plot.addEventListener('pointerup', event => {
      const to = place(event);
      if (from !== null && Math.abs(to[0] - from[0]) > 4 && Math.abs(to[1] - from[1]) > 4) {
        const [a, b] = [from, to].map(p => chart.unplace(p));
        chart.view = [0, 1].map(i => [Math.min(a[i], b[i]), Math.max(a[i], b[i])]);
      }
      [from, chart.mark] = [null, null];
      this.draw();
    });
    plot.addEventListener('dblclick', () => { chart.view = null; this.draw(); });
  }

  setCursor(t) {
    this.cursor = t;
    this.draw();
  }

  draw() {
    this.width = Math.max(this.root.clientWidth, 320);
    if (this.axis) this.charts.forEach(chart => this.drawChart(chart));
  }

  drawChart(chart) {
    const { svg, shown, ticks, number } = mocc;
    const { panel, plot, values } = chart;
    const [left, right, top, bottom, height] = [62, this.width - 14, 6, 260, 296];
    const scales = [this.axis.scale, panel.scale];
    const range = i => {
      let [low, high] = [Infinity, -Infinity];
      for (const c of panel.curves) {
        for (const raw of i === 0 ? c.x : c.y) {
          const v = shown(raw, scales[i]);
          if (v < low) low = v;
          if (v > high) high = v;
        }
      }
      if (!(high >= low)) return [0, 1];
      const room = high > low ? 0.05 * (high - low) : 0.1 * Math.abs(high) || 1;
      return [low - room, high + room];
    };
    const view = chart.view ?? [range(0), range(1)];
    const x = v => left + (right - left) * (v - view[0][0]) / (view[0][1] - view[0][0]);
    const y = v => bottom - (bottom - top) * (v - view[1][0]) / (view[1][1] - view[1][0]);
    chart.unplace = ([px, py]) => [
      view[0][0] + (px - left) / (right - left) * (view[0][1] - view[0][0]),
      view[1][0] + (bottom - py) / (bottom - top) * (view[1][1] - view[1][0]),
    ];
    plot.setAttribute('viewBox', `0 0 ${this.width} ${height}`);
    plot.setAttribute('height', height);
    plot.replaceChildren();
    const clip = `plane-${chart.k}`;
    const frame = { x: left, y: top, width: right - left, height: bottom - top };
    svg('rect', frame, svg('clipPath', { id: clip }, svg('defs', {}, plot)));
    svg('rect', { ...frame, class: 'paper' }, plot);
    for (const v of ticks(...view[1], 5, false)) {
      svg('path', { d: `M${left} ${y(v)}H${right}`, class: 'grid' }, plot);
      svg('text', { x: left - 7, y: y(v) + 4, 'text-anchor': 'end' }, plot, number(v, 6));
    }
    for (const v of ticks(...view[0], Math.max(2, Math.floor(this.width / 110)), false)) {
      svg('path', { d: `M${x(v)} ${top}V${bottom}`, class: 'grid' }, plot);
      svg('text', { x: x(v), y: bottom + 15, 'text-anchor': 'middle' }, plot, number(v, 6));
    }
    const unit = this.axis.scale.unit;
    svg('text', { x: right, y: bottom + 31, 'text-anchor': 'end' }, plot, `${this.axis.name}${unit ? ` in ${unit}` : ''}`);
    const inside = svg('g', { 'clip-path': `url(#${clip})` }, plot);
    panel.curves.forEach((c, i) => {
      const at = k => [shown(c.x[k], scales[0]), shown(c.y[k], scales[1])];
      let [path, last] = ['', ''];
      for (let k = 0; k < c.time.length; k++) {
        const [px, py] = at(k);
        const place = `${x(px).toFixed(1)} ${y(py).toFixed(1)}`;
        if (place !== last) path += `${path ? 'L' : 'M'}${place}`;
        last = place;
      }
      this.stroke(c, path, inside).classList.add('trace');
      if (this.cursor === null) return;
      const k = Math.max(0, mocc.before(c.time, this.cursor));
      const [px, py] = at(k);
      const dot = svg('circle', { cx: x(px), cy: y(py), r: 4 }, inside);
      dot.style.fill = c.colour;
      values[i].textContent = `${number(px)}, ${number(py)}`;
    });
    if (chart.mark) {
      const [[a, b], [c, d]] = chart.mark;
      const box = { x: Math.min(a, c), y: Math.min(b, d), width: Math.abs(a - c), height: Math.abs(b - d) };
      svg('rect', { ...box, class: 'mark' }, inside);
    }
  }
};
