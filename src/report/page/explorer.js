// The report: which variables of which runs are shown, the diagram's levels, events and filters.
mocc.report = () => {
  const data = mocc.data('mocc-data');
  const { html } = mocc;
  const decoded = [];
  const array = k => decoded[k] ??= mocc.decode(data.arrays[k]);
  const byName = new Map(data.variables.map((v, k) => [v.name, k]));

  // A variable of a run as a curve; constants are two points.
  function curve(run, k) {
    const column = run.columns[k];
    if (!Array.isArray(column)) {
      return { x: Float64Array.from(run.ends), y: Float64Array.from([column, column]), factor: 1 };
    }
    return { x: array(column[0]), y: array(column[1]), factor: column[2] };
  }
  const value = (run, k, t) => mocc.at(curve(run, k), t);
  const all = (run, k) => { const c = curve(run, k); return Array.from(c.y, y => c.factor * y); };

  // ---- Traces ----

  const several = data.runs.length > 1;
  const chosen = data.show.map(n => byName.get(n)).filter(k => k !== undefined);
  const root = document.getElementById('explorer');
  const chooser = html('div', { class: 'chooser' }, root);
  const right = html('div', {}, root);
  const bar = html('div', { class: 'toolbar' }, right);
  const element = html('div', { class: 'figure', id: 'traces-figure' }, right);
  const figure = new mocc.Figure(element, data.time);
  const planes = html('div', { class: 'figure', id: 'plane-figure', hidden: '' }, right);
  const plane = new mocc.Plane(planes);
  html('span', { class: 'gestures' }, bar, 'drag or wheel: zoom · shift + drag: move · double click: all');
  const reset = html('button', {}, bar, 'show all');
  reset.addEventListener('click', () => figure.showAll());
  const choice = (label, options, then) => {
    const select = html('select', { 'aria-label': label, title: label }, bar);
    options.forEach(([value, text]) => html('option', { value }, select, text));
    select.addEventListener('change', then);
    return select;
  };
  const layout = choice('charts', [
    ...several ? [['each', 'a chart each'], ['unit', 'a chart for each unit']] : [['unit', 'a chart for each unit'], ['each', 'a chart each']],
    ['pairs', 'two units in a chart'],
  ], () => panels());
  const over = choice('over', [], () => panels());
  const log = html('button', { 'aria-pressed': 'false' }, bar, 'log time');
  log.addEventListener('click', () => {
    figure.setLogTime(!figure.logTime);
    log.setAttribute('aria-pressed', figure.logTime);
  });
  const marks = html('button', { 'aria-pressed': 'false' }, bar, 'events');
  marks.addEventListener('click', () => {
    marks.setAttribute('aria-pressed', marks.getAttribute('aria-pressed') === 'false');
    panels();
  });

  // Of several runs each has its colour, from dark to light if there are many.
  function colourOf(r) {
    const n = data.runs.length;
    if (n <= mocc.COLOURS.length) return mocc.COLOURS[r];
    return `hsl(${260 - 230 * r / (n - 1)} 75% ${30 + 12 * r / (n - 1)}%)`;
  }

  // What the charts stand over: the time, or one of the variables that are chosen.
  function offerAxes() {
    const now = over.value;
    over.replaceChildren();
    html('option', { value: '' }, over, 'over time');
    chosen.forEach(k => html('option', { value: k }, over, `over ${data.variables[k].name}`));
    over.value = chosen.includes(Number(now)) && now !== '' ? now : '';
  }

  // The groups of variables that share a chart.
  function grouped() {
    const groups = new Map();
    for (const k of chosen) {
      const v = data.variables[k];
      const key = layout.value === 'each' ? `${k}` : `${v.unit}|${v.low}|${v.whole}`;
      if (!groups.has(key)) groups.set(key, []);
      groups.get(key).push(k);
    }
    return [...groups.values()];
  }

  const DASHES = ['', '7 3', '2 3', '9 3 2 3'];
  // Of one run each variable has its colour; of several each run, and the variables of a chart differ by their dashes.
  const looks = (i, r, count) => several
    ? { colour: colourOf(r), dash: count > 1 ? DASHES[i % DASHES.length] : '' }
    : { colour: mocc.COLOURS[i % mocc.COLOURS.length] };

  // The variables over another one.
  function overVariable(abscissa) {
    const a = data.variables[abscissa];
    const rows = (run, k, time) => {
      const c = curve(run, k);
      return Float64Array.from(time, (t, row) => c.y.length === time.length ? c.factor * c.y[row] : mocc.at(c, t));
    };
    const shown = grouped().map(group => group.filter(k => k !== abscissa)).filter(group => group.length > 0).map(group => {
      const largest = group.reduce((x, k) => data.variables[k].largest > data.variables[x].largest ? k : x, group[0]);
      const { scale, quantity } = data.variables[largest];
      const curves = group.flatMap((k, i) => data.runs.map((run, r) => {
        const time = timesOf(run);
        const name = [group.length > 1 || !several ? data.variables[k].name : '', several ? run.label : ''].filter(Boolean).join(' ');
        return { name, time, x: rows(run, abscissa, time), y: rows(run, k, time), ...looks(i, r, group.length) };
      }));
      return { label: group.length > 1 ? quantity : data.variables[group[0]].name, scale, curves };
    });
    plane.show({ name: a.name, scale: a.scale }, shown);
  }

  // The instants of a run: those of its longest column.
  function timesOf(run) {
    const columns = run.columns.filter(Array.isArray).map(c => array(c[0]));
    return columns.reduce((a, b) => b.length > a.length ? b : a, Float64Array.from(run.ends));
  }

  // Two groups in a chart, the second with the axis on the right.
  function paired(shown) {
    const out = [];
    const free = shown.filter(p => !p.low);
    for (let k = 0; k + 1 < free.length; k += 2) {
      const [a, b] = [free[k], free[k + 1]];
      const offset = several ? 0 : a.curves.length;
      const second = b.curves.map(c => ({ ...c, right: true, ...several ? { dash: '7 3' } : {} }));
      if (!several) second.forEach((c, i) => { if (!c.points) c.colour = mocc.COLOURS[(offset + i) % mocc.COLOURS.length]; });
      out.push({ ...a, right: { label: b.label, scale: b.scale }, curves: [...a.curves, ...second] });
    }
    if (free.length % 2) out.push(free[free.length - 1]);
    return [...out, ...shown.filter(p => p.low)];
  }

  function panels() {
    offerAxes();
    planes.hidden = over.value === '';
    element.hidden = !planes.hidden;
    if (!planes.hidden) overVariable(Number(over.value));
    const shown = [];
    for (const group of grouped()) {
      const largest = group.reduce((a, k) => data.variables[k].largest > data.variables[a].largest ? k : a, group[0]);
      const { scale, quantity, low } = data.variables[largest];
      const only = group.length === 1 ? data.variables[group[0]] : null;
      const curves = [];
      group.forEach((k, i) => {
        const v = data.variables[k];
        const remove = () => { chosen.splice(chosen.indexOf(k), 1); update(); };
        for (const m of data.measured.filter(m => m.variable === v.name)) {
          curves.push({
            name: `${several || group.length === 1 ? '' : v.name + ' '}${m.label}`, title: `measured: ${m.label}`,
            x: array(m.time), y: array(m.values), factor: 1, points: true, colour: several || group.length === 1 ? '#5b6470' : mocc.COLOURS[i % mocc.COLOURS.length],
          });
        }
        data.runs.forEach((run, r) => curves.push({
          name: several ? `${group.length > 1 || layout.value === 'pairs' ? v.name + ' ' : ''}${run.label}` : v.name,
          title: `${v.name}${v.text ? ': ' + v.text : ''}`,
          ...looks(i, r, group.length),
          remove: several ? null : remove,
          ...curve(run, k),
        }));
      });
      const label = only ? [only.name, only.text].filter(Boolean).join(': ') : quantity;
      const wanted = marks.getAttribute('aria-pressed') === 'true' ? data.runs.flatMap(r => r.events) : [];
      shown.push({ label, scale, low, curves, marks: wanted });
    }
    figure.show(layout.value === 'pairs' ? paired(shown) : shown);
    figure.setCursor(figure.cursor);
  }
  figure.heard.push(t => plane.setCursor(t));

  // ---- The view as a file ----

  const visible = () => planes.hidden ? element : planes;
  const name = document.querySelector('h1').textContent.replace(/[^\w.-]+/g, '_');
  const picture = () => mocc.save.picture(visible());
  html('button', { title: 'save this view as a picture' }, bar, 'SVG')
    .addEventListener('click', () => mocc.save.offer(`${name}.svg`, 'image/svg+xml', picture()));
  const table = () => {
    const all = [...new Set([...over.value === '' ? [] : [Number(over.value)], ...chosen])];
    const runs = data.runs.map(run => {
      const time = timesOf(run);
      const columns = all.map(k => {
        const c = curve(run, k);
        const at = row => c.y.length === time.length ? c.factor * c.y[row] : mocc.at(c, time[row]);
        return { name: data.variables[k].name, unit: data.variables[k].unit, at };
      });
      return { label: run.label, time, columns };
    });
    return mocc.save.table(runs, planes.hidden ? figure.view : figure.whole);
  };
  html('button', { title: 'save the rows of this view as a table' }, bar, 'CSV')
    .addEventListener('click', () => mocc.save.offer(`${name}.csv`, 'text/csv', table()));

  // ---- The tree of variables ----

  const search = html('input', { type: 'search', placeholder: 'find a variable', 'aria-label': 'find a variable' }, chooser);
  const tree = html('div', { class: 'tree' }, chooser);
  const boxes = new Map();

  function leaf(k, parent, full) {
    const v = data.variables[k];
    const label = html('label', { title: v.text || v.name }, parent);
    const box = html('input', { type: 'checkbox' }, label);
    box.checked = chosen.includes(k);
    box.addEventListener('change', () => {
      if (box.checked) chosen.push(k); else chosen.splice(chosen.indexOf(k), 1);
      update();
    });
    html('span', {}, label, full ? v.name : v.name.slice(v.name.lastIndexOf('.') + 1));
    html('i', {}, label, v.scale.unit);
    boxes.set(k, box);
  }

  // Branches are filled when they are opened: a model may have thousands of variables.
  function branch(prefix, members, parent) {
    const inner = new Map();
    for (const k of members) {
      const name = data.variables[k].name;
      const dot = name.indexOf('.', prefix.length);
      const derived = name.startsWith('der(');
      if (prefix === 'derivatives.' || (dot < 0 && !derived)) { leaf(k, parent, derived); continue; }
      const next = derived ? 'derivatives' : name.slice(prefix.length, dot);
      if (!inner.has(next)) inner.set(next, []);
      inner.get(next).push(k);
    }
    for (const [name, list] of inner) {
      const details = html('details', {}, parent);
      html('summary', {}, details, name);
      details.addEventListener('toggle', () => {
        if (details.open && details.children.length === 1) branch(`${prefix}${name}.`, list, details);
      });
    }
  }

  function grow() {
    tree.replaceChildren();
    boxes.clear();
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    if (words.length === 0) {
      branch('', data.variables.map((_, k) => k), tree);
      return;
    }
    const found = data.variables
      .map((v, k) => [`${v.name} ${v.text}`.toLowerCase(), k])
      .filter(([text]) => words.every(w => text.includes(w)));
    found.slice(0, 300).forEach(([, k]) => leaf(k, tree, true));
    if (found.length > 300) html('p', {}, tree, `and ${found.length - 300} more`);
  }
  search.addEventListener('input', grow);

  function update() {
    boxes.forEach((box, k) => { box.checked = chosen.includes(k); });
    panels();
  }

  grow();
  panels();

  // ---- Moving parts ----

  const spool = mocc.data('mocc-spool');
  let machine = null;
  if (spool) {
    machine = mocc.machine(document.getElementById('spool-figure'), spool, data, value, all, t => { figure.setCursor(t); plane.setCursor(t); });
    figure.heard.push(t => machine.go(t));
  }
  const go = t => { figure.setCursor(t); plane.setCursor(t); machine?.go(t); };

  // ---- Diagram ----

  const levels = new Map([...document.querySelectorAll('.level')].map(l => [l.dataset.level, l]));
  const crumbs = document.getElementById('crumbs');
  function open(name) {
    levels.forEach((l, n) => { l.hidden = n !== name; });
    crumbs.replaceChildren();
    crumbs.hidden = name === '';
    let path = '';
    const step = (target, text) => html('button', {}, crumbs, text).addEventListener('click', () => open(target));
    step('', 'whole model');
    for (const part of name.split('.').filter(Boolean)) {
      path = path ? `${path}.${part}` : part;
      if (levels.has(path)) step(path, part);
    }
  }
  document.querySelectorAll('.schematic .part').forEach(part => {
    const name = part.dataset.part;
    if (!levels.has(name)) { part.classList.remove('opens'); return; }
    part.setAttribute('tabindex', '0');
    part.addEventListener('click', () => open(name));
    part.addEventListener('keydown', e => { if (e.key === 'Enter') open(name); });
  });

  // ---- Events, places, filters ----

  document.querySelectorAll('.events tr[data-time]').forEach(row => {
    const act = () => go(Number(row.dataset.time));
    row.addEventListener('click', act);
    row.addEventListener('keydown', e => { if (e.key === 'Enter') act(); });
  });
  document.querySelectorAll('.place a').forEach(a => a.addEventListener('click', () => {
    // What is folded cannot be scrolled to.
    document.querySelector(a.getAttribute('href'))?.closest('details')?.setAttribute('open', '');
  }));
  document.querySelectorAll('.filter').forEach(input => input.addEventListener('input', () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    document.getElementById(input.dataset.filter).querySelectorAll('details').forEach(group => {
      let any = false;
      group.querySelectorAll('tr[data-find]').forEach(row => {
        row.hidden = !words.every(w => row.dataset.find.includes(w));
        any ||= !row.hidden;
      });
      group.hidden = !any;
      if (words.length > 0 && any) group.open = true;
    });
  }));

  // What tests look at.
  window.__mocc = { data, figure, plane, machine, chosen, value, byName, array, open, go, update, layout, over, picture, table };
};
