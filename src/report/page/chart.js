'use strict';
// Charts of all pages: panels of curves above each other over one axis of time.
//
//   drag            zoom into what is marked: sideways the time, up and down the values, slanted both
//   wheel           zoom about the pointer, beside the axis of values zoom those
//   shift + drag    move                            double click   everything again
//   arrow keys      move the cursor                 log            logarithmic axis
//
// Panels of one figure share their time, and so do figures that are linked. Values at the cursor stand
// beside the names. Nothing is loaded from anywhere.
const mocc = (() => {
  const SVG = 'http://www.w3.org/2000/svg';
  // Names of the style sheet, which has them for light and dark ground.
  const COLOURS = [0, 1, 2, 3, 4, 5, 6, 7].map(k => `var(--c${k})`);
  // TICKS is the room for the times below a panel, AXIS with the name of the axis, BAND the height of a mark that zooms values.
  const LEFT = 62, WIDE = 14, TOP = 6, TICKS = 22, AXIS = 36, BAND = 24;

  // ---- Data ----

  // Base64 of little-endian numbers.
  function decode(array) {
    const text = atob(array.f64 ?? array.f32);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return 'f64' in array ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
  }

  function data(id) {
    const element = document.getElementById(id);
    return element ? JSON.parse(element.textContent) : null;
  }

  // The last row at or before `x`; of two rows at an event the second.
  function before(xs, x) {
    let low = 0, high = xs.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (xs[middle] <= x) low = middle + 1; else high = middle;
    }
    return low - 1;
  }

  // The value of a curve at `x`, on the line between two rows; NaN outside.
  function at(curve, x) {
    const { x: xs, y: ys } = curve;
    const i = before(xs, x);
    if (i < 0 || x > xs[xs.length - 1]) return NaN;
    if (i + 1 >= xs.length || xs[i + 1] === xs[i]) return curve.factor * ys[i];
    const part = (x - xs[i]) / (xs[i + 1] - xs[i]);
    return curve.factor * (ys[i] + part * (ys[i + 1] - ys[i]));
  }

  // ---- Texts ----

  function shown(value, scale) {
    return value / scale.size - scale.zero;
  }

  function figures(x, digits = 5) {
    if (!Number.isFinite(x)) return '';
    const size = Math.abs(x);
    if (x !== 0 && (size < 1e-3 || size >= 1e7)) return x.toExponential(digits - 2).replaceAll('-', '−');
    return String(Number(x.toPrecision(digits))).replace('-', '−');
  }

  // About `wanted` round numbers between `low` and `high`.
  function ticks(low, high, wanted, log) {
    const out = [];
    if (!(high > low)) return [low];
    if (log) {
      const [a, b] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
      if (b > a) {
        const step = Math.max(1, Math.ceil((b - a) / wanted));
        for (let k = a; k <= b; k += step) out.push(10 ** k);
        return out;
      }
    }
    const raw = (high - low) / Math.max(1, wanted);
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find(m => m * power >= raw * 0.999);
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) {
      out.push(Number((k * step).toPrecision(12)));
    }
    return out;
  }

  // ---- Elements ----

  function svg(name, attributes = {}, parent = null, text = null) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== null) element.textContent = text;
    if (parent) parent.append(element);
    return element;
  }

  function html(name, attributes = {}, parent = null, text = null) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== null) element.textContent = text;
    if (parent) parent.append(element);
    return element;
  }

  // ---- Figures ----

  // A figure in `root`. `time` is the scale of the abscissa. Panels are
  // { label, scale, low, height, curves: [{ name, x, y, factor, points, colour, dash, title }], marks, remove }.
  class Figure {
    constructor(root, time, abscissa = 'time') {
      this.abscissa = abscissa;
      this.root = root;
      this.time = time;
      this.panels = [];
      this.view = null;
      this.logTime = false;
      this.cursor = null;
      this.heard = [];
      const observer = new ResizeObserver(() => this.draw());
      observer.observe(root);
      window.addEventListener('beforeprint', () => this.draw());
    }

    // Shows these panels and keeps what was zoomed.
    show(panels) {
      this.root.querySelectorAll(':scope > .panel').forEach(p => p.remove());
      this.panels = panels.map((panel, k) => this.build(panel, k));
      this.whole = this.extent();
      if (this.view === null) this.view = this.whole.slice();
      this.draw();
    }

    extent() {
      let [low, high] = [Infinity, -Infinity];
      for (const { panel } of this.panels) {
        for (const c of panel.curves) {
          if (c.x.length) [low, high] = [Math.min(low, c.x[0]), Math.max(high, c.x[c.x.length - 1])];
        }
      }
      if (!(high >= low)) [low, high] = [0, 1];
      return high > low ? [low, high] : [low - 0.5, high + 0.5];
    }

    build(panel, k) {
      const element = html('div', { class: 'panel' }, this.root);
      const header = html('header', {}, element);
      const axis = (label, scale) => [label, scale.unit && `in ${scale.unit}`].filter(Boolean).join(' ');
      html('span', { class: 'axis' }, header, axis(panel.label, panel.scale));
      if (panel.right) html('span', { class: 'axis' }, header, `right: ${axis(panel.right.label, panel.right.scale)}`);
      const values = panel.curves.map(c => {
        const item = html('span', { class: 'curve', title: c.title ?? c.name }, header);
        const key = svg('svg', { width: 20, height: 10, 'aria-hidden': 'true' }, item);
        this.stroke(c, c.points ? 'M3 5h0M10 5h0M17 5h0' : 'M0 5H20', key);
        html('span', {}, item, c.name);
        const value = html('span', { class: 'value' }, item);
        if (c.remove) {
          const button = html('button', { title: `without ${c.name}`, 'aria-label': `without ${c.name}` }, item, '×');
          button.addEventListener('click', c.remove);
        }
        return value;
      });
      const log = html('button', { 'aria-pressed': 'false', title: 'logarithmic axis' }, header, 'log');
      const all = panel.curves.flatMap(c => c.points ? [] : [c]);
      const some = is => all.some(c => c.y.some(y => is(c.factor * y)));
      log.hidden = panel.low || !some(y => y > 0) || some(y => y < 0);
      const plot = svg('svg', { role: 'img', tabindex: '0', 'aria-label': panel.label || 'curves' }, element);
      const own = { panel, element, values, plot, log: false, k, band: null };
      log.addEventListener('click', () => {
        own.log = !own.log;
        log.setAttribute('aria-pressed', own.log);
        this.draw();
      });
      this.listen(own);
      return own;
    }

    stroke(c, path, parent) {
      const colour = c.colour.startsWith ? c.colour : COLOURS[c.colour % COLOURS.length];
      const style = c.points
        ? { 'stroke-width': 3, 'stroke-linecap': 'round', 'stroke-opacity': 0.55 }
        : { 'stroke-width': 1.7, 'stroke-linejoin': 'round' };
      if (c.dash) style['stroke-dasharray'] = c.dash;
      const element = svg('path', { d: path, fill: 'none', ...style }, parent);
      element.style.stroke = colour;
      return element;
    }

    // Pointer, wheel and keys.
    listen(own) {
      const plot = own.plot;
      const x = event => this.timeAt(event.clientX - plot.getBoundingClientRect().left);
      const height = event => event.clientY - plot.getBoundingClientRect().top;
      let from = null;
      plot.addEventListener('pointerdown', event => {
        if (event.button !== 0) return;
        const band = own.band && own.band.slice();
        from = { x: event.clientX, y: height(event), time: x(event), view: this.view.slice(), move: event.shiftKey, band };
        plot.setPointerCapture(event.pointerId);
      });
      plot.addEventListener('pointermove', event => {
        if (from === null) return this.point(x(event));
        if (from.move) {
          const by = (from.x - event.clientX) / (this.right() - LEFT);
          const [a, b] = from.view.map(t => this.part(t));
          if (from.band) {
            const [low, high] = from.band;
            const up = (height(event) - from.y) / (own.bottom - TOP) * (high - low);
            own.band = [low + up, high + up];
          }
          this.zoom([this.unpart(a + by * (b - a)), this.unpart(b + by * (b - a))]);
        } else {
          const far = Math.abs(event.clientX - from.x) > 4, high = Math.abs(height(event) - from.y) > BAND;
          this.mark = { own, times: far || !high ? [from.time, x(event)] : null, heights: high ? [from.y, height(event)] : null };
          this.point(x(event));
          this.draw();
        }
      });
      const end = event => {
        if (from === null) return;
        const mark = this.mark;
        const far = Math.abs(event.clientX - from.x) > 4 || mark?.heights;
        [from, this.mark] = [null, null];
        if (!mark || !far || event.type !== 'pointerup') return this.draw();
        if (mark.heights) own.band = mark.heights.map(h => own.unplace(h)).sort((p, q) => p - q);
        const times = mark.times ?? this.view;
        this.zoom([Math.min(...times), Math.max(...times)]);
      };
      plot.addEventListener('pointerup', end);
      plot.addEventListener('pointercancel', end);
      plot.addEventListener('dblclick', () => this.showAll());
      plot.addEventListener('wheel', event => {
        event.preventDefault();
        const factor = Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0015));
        if (event.clientX - plot.getBoundingClientRect().left < LEFT) {
          const about = own.unplace(height(event));
          own.band = [own.shown.low, own.shown.high].map(v => about + (v - about) * factor);
          return this.draw();
        }
        const middle = this.part(x(event));
        this.zoom(this.view.map(t => this.unpart(middle + (this.part(t) - middle) * factor)));
      }, { passive: false });
      plot.addEventListener('keydown', event => {
        const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
        if (!step) return;
        event.preventDefault();
        const wide = (this.view[1] - this.view[0]) / (event.shiftKey ? 20 : 200);
        this.point((this.cursor ?? this.view[0]) + step * wide);
      });
    }

    // From times to what is evenly spaced, and back.
    part(t) { return this.logTime ? Math.log10(Math.max(t, this.least())) : t; }
    unpart(p) { return this.logTime ? 10 ** p : p; }

    // The least positive time: where a logarithmic axis begins.
    least() {
      const firsts = this.panels.flatMap(({ panel }) => panel.curves.map(c => c.x.find(t => t > 0) ?? Infinity));
      const least = Math.min(...firsts);
      return Number.isFinite(least) ? least : 1e-12;
    }

    timeAt(px) {
      const [a, b] = this.view.map(t => this.part(t));
      return this.unpart(a + (b - a) * (px - LEFT) / (this.right() - LEFT));
    }

    place(t) {
      const [a, b] = this.view.map(t => this.part(t));
      return LEFT + (this.right() - LEFT) * (this.part(t) - a) / (b - a);
    }

    // Where the curves end: before a second axis of values, if a panel has one.
    right() { return this.width - (this.panels.some(own => own.panel.right) ? LEFT : WIDE); }

    // All times and all values.
    showAll() {
      this.panels.forEach(own => { own.band = null; });
      this.zoom(this.whole);
    }

    // Shows a part of the time; at least some rounding errors wide, never beyond what there is.
    zoom([a, b]) {
      const [low, high] = this.whole;
      const least = (high - low) * 1e-9;
      if (!(b - a > least)) return;
      const wide = Math.min(b - a, high - low);
      if (a < low) [a, b] = [low, low + wide];
      if (b > high) [a, b] = [high - wide, high];
      this.view = [Math.max(a, low), Math.min(b, high)];
      this.draw();
    }

    setLogTime(on) {
      this.logTime = on;
      this.view = this.whole.slice();
      if (on) this.view[0] = Math.max(this.view[0], this.least());
      this.draw();
    }

    // Puts the cursor at a time and says so.
    point(t) {
      const time = Math.min(Math.max(t, this.whole[0]), this.whole[1]);
      this.setCursor(time);
      this.heard.forEach(hear => hear(time));
    }

    setCursor(t) {
      this.cursor = t;
      for (const own of this.panels) {
        own.panel.curves.forEach((c, i) => {
          const scale = c.right ? own.panel.right.scale : own.panel.scale;
          own.values[i].textContent = t === null ? '' : figures(shown(at(c, t), scale));
        });
        this.drawCursor(own);
      }
    }

    drawCursor(own) {
      if (!own.line) return;
      const x = this.cursor === null ? -1 : this.place(this.cursor);
      const visible = x >= LEFT - 0.5 && x <= this.right() + 0.5;
      own.line.setAttribute('visibility', visible ? 'visible' : 'hidden');
      own.line.setAttribute('x1', x);
      own.line.setAttribute('x2', x);
      own.label?.setAttribute('visibility', visible ? 'visible' : 'hidden');
      if (own.label && visible) {
        const text = `${figures(shown(this.cursor, this.time), 6)} ${this.time.unit}`;
        own.label.textContent = text;
        own.label.setAttribute('x', Math.min(Math.max(x, LEFT + 40), this.right() - 40));
      }
    }

    draw() {
      this.width = Math.max(this.root.clientWidth, 320);
      if (this.view === null) return;
      this.panels.forEach((own, k) => this.drawPanel(own, k === this.panels.length - 1));
    }

    drawPanel(own, last) {
      const { panel, plot } = own;
      const below = last ? AXIS : TICKS;
      const high = (panel.height ?? (panel.low ? 64 : 168)) + below;
      const bottom = high - below, right = this.right();
      plot.setAttribute('viewBox', `0 0 ${this.width} ${high}`);
      plot.setAttribute('height', high);
      plot.replaceChildren();
      const clip = `clip-${this.root.id}-${own.k}`;
      const frame = { x: LEFT, y: TOP, width: right - LEFT, height: bottom - TOP };
      svg('rect', frame, svg('clipPath', { id: clip }, svg('defs', {}, plot)));
      svg('rect', { ...frame, class: 'paper' }, plot);
      const range = own.shown = own.band
        ? { low: own.band[0], high: own.band[1], least: own.log ? this.range(own, false).least : 0 }
        : this.range(own, false);
      const warp = v => own.log ? Math.log10(Math.max(v, range.least)) : v;
      const [low, top] = [warp(range.low), warp(range.high)];
      const y = v => bottom - (bottom - TOP) * (warp(v) - low) / (top - low);
      Object.assign(own, { y, bottom });
      own.unplace = py => {
        const v = low + (bottom - py) / (bottom - TOP) * (top - low);
        return own.log ? 10 ** v : v;
      };

      const wanted = panel.low ? 1 : panel.height < 120 ? 4 : 5;
      const label = (px, py, anchor, text) => svg('text', { x: px, y: py, 'text-anchor': anchor }, plot, text);
      for (const v of ticks(range.low, range.high, wanted, own.log)) {
        const py = y(v);
        if (py < TOP - 1 || py > bottom + 1) continue;
        svg('path', { d: `M${LEFT} ${py}H${right}`, class: 'grid' }, plot);
        label(LEFT - 7, py + 4, 'end', figures(v, 6));
      }
      let other = y;
      if (panel.right) {
        const second = this.range(own, true);
        other = v => bottom - (bottom - TOP) * (v - second.low) / (second.high - second.low);
        for (const v of ticks(second.low, second.high, wanted, false)) label(right + 7, other(v) + 4, 'start', figures(v, 6));
      }
      const [a, b] = this.view.map(t => shown(t, this.time));
      for (const t of ticks(a, b, Math.max(2, Math.floor(this.width / 110)), this.logTime)) {
        const px = this.place((t + this.time.zero) * this.time.size);
        svg('path', { d: `M${px} ${TOP}V${bottom}`, class: 'grid' }, plot);
        label(px, bottom + 15, 'middle', figures(t, 6));
      }
      if (last) label(right, bottom + 31, 'end', `${this.abscissa} in ${this.time.unit}`);
      const inside = svg('g', { 'clip-path': `url(#${clip})` }, plot);
      for (const t of panel.marks ?? []) {
        const px = this.place(t);
        if (px >= LEFT && px <= right) svg('path', { d: `M${px} ${TOP}V${bottom}`, class: 'event' }, inside);
      }
      for (const c of panel.curves) {
        const scale = c.right ? panel.right.scale : panel.scale;
        this.stroke(c, this.path(c, scale, c.right ? other : y), inside).classList.add('trace');
      }
      if (this.mark && (this.mark.times || this.mark.own === own)) {
        const [from, to] = this.mark.times?.map(t => this.place(t)).sort((p, q) => p - q) ?? [LEFT, right];
        const [upper, lower] = this.mark.own === own && this.mark.heights?.toSorted((p, q) => p - q) || [TOP, bottom];
        svg('rect', { x: from, y: upper, width: to - from, height: lower - upper, class: 'mark' }, inside);
      }
      own.line = svg('line', { y1: TOP, y2: bottom, visibility: 'hidden', class: 'cursor' }, plot);
      own.label = last ? svg('text', { y: bottom + 31, 'text-anchor': 'middle', 'font-weight': 600, visibility: 'hidden' }, plot) : null;
      this.drawCursor(own);
    }

    // The range of what is visible over one of the axes, with a little room, in shown units.
    range(own, right) {
      let [low, high, least] = [Infinity, -Infinity, Infinity];
      const scale = right ? own.panel.right.scale : own.panel.scale;
      for (const c of own.panel.curves) {
        if ((c.right ?? false) !== right) continue;
        const first = Math.max(0, before(c.x, this.view[0]));
        const last = Math.min(c.x.length - 1, before(c.x, this.view[1]) + 1);
        for (let i = first; i <= last; i++) {
          const v = shown(c.factor * c.y[i], scale);
          if (!Number.isFinite(v)) continue;
          if (v > 0 && v < least) least = v;
          if (v < low) low = v;
          if (v > high) high = v;
        }
      }
      if (!(high >= low)) [low, high] = [0, 1];
      if (own.log && !right) {
        if (!Number.isFinite(least)) least = 1;
        return { low: Math.max(low, least) / 1.2, high: Math.max(high, 2 * least) * 1.2, least: least / 1.2 };
      }
      if (own.panel.low) return { low: Math.min(low, 0) - 0.15, high: Math.max(high, 1) + 0.15 };
      const room = high > low ? 0.06 * (high - low) : 0.1 * Math.abs(high) || 1;
      return { low: low - room, high: high + room };
    }

    // The path of what is visible. Of all points in one column of pixels the first, the lowest, the
    // highest and the last are enough.
    path(c, scale, y) {
      const first = Math.max(0, before(c.x, this.view[0]) - 1);
      const last = Math.min(c.x.length - 1, before(c.x, this.view[1]) + 1);
      const value = i => y(shown(c.factor * c.y[i], scale));
      const out = [];
      const draw = (i, move) => {
        const px = this.place(c.x[i]).toFixed(1), py = value(i).toFixed(1);
        out.push(c.points ? `M${px} ${py}h0` : `${move ? 'M' : 'L'}${px} ${py}`);
      };
      const thin = last - first > 4 * this.width;
      let move = true;
      for (let i = first; i <= last; i++) {
        if (!Number.isFinite(c.y[i])) { move = true; continue; }
        if (!thin) { draw(i, move); move = false; continue; }
        const column = Math.floor(this.place(c.x[i]));
        let [j, low, high] = [i, i, i];
        while (j + 1 <= last && Math.floor(this.place(c.x[j + 1])) === column) {
          j++;
          if (c.factor * c.y[j] < c.factor * c.y[low]) low = j;
          if (c.factor * c.y[j] > c.factor * c.y[high]) high = j;
        }
        for (const k of [...new Set([i, low, high, j])].sort((p, q) => p - q)) { draw(k, move); move = false; }
        i = j;
      }
      return out.join('');
    }
  }

  // Figures whose panels stand in the page.
  function figuresOf() {
    document.querySelectorAll('.figure[data-figure]').forEach(root => {
      const spec = data(root.dataset.figure);
      let figure = null;
      // Those in closed parts of the page are made when they are seen.
      const make = () => {
        if (figure !== null || root.offsetParent === null) return;
        const arrays = spec.arrays.map(decode);
        figure = new Figure(root, spec.time, spec.abscissa);
        figure.show(spec.panels.map(p => ({
          ...p,
          curves: p.curves.map(c => ({ ...c, factor: 1, x: arrays[c.x], y: arrays[c.y] })),
        })));
      };
      make();
      root.closest('details')?.addEventListener('toggle', make);
    });
  }

  return { Figure, COLOURS, decode, data, before, at, shown, figures: figuresOf, number: figures, ticks, svg, html };
})();
