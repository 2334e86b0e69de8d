// The view as a file: a picture with its legends, or the rows that are visible.
mocc.save = (() => {
  // Offers a text under a name.
  function offer(name, type, text) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  const DRAWN = ['fill', 'fill-opacity', 'stroke', 'stroke-width', 'stroke-opacity', 'stroke-dasharray', 'stroke-linecap',
    'stroke-linejoin', 'font-size', 'font-weight', 'text-anchor', 'visibility'];

  // A copy of a drawing that needs no style sheet.
  function plain(from) {
    const copy = from.cloneNode(true);
    const [was, is] = [[from, ...from.querySelectorAll('*')], [copy, ...copy.querySelectorAll('*')]];
    was.forEach((element, k) => {
      const style = getComputedStyle(element);
      is[k].removeAttribute('class');
      is[k].removeAttribute('style');
      for (const name of DRAWN) is[k].setAttribute(name, style.getPropertyValue(name));
    });
    return copy;
  }

  // All panels of a figure below each other, each under its legend, as one picture.
  function picture(root) {
    const { svg } = mocc;
    const style = getComputedStyle(document.body);
    const out = svg('svg', { xmlns: 'http://www.w3.org/2000/svg', 'font-family': 'Inter, system-ui, sans-serif', 'font-size': 12 });
    const ground = svg('rect', { fill: getComputedStyle(document.documentElement).getPropertyValue('--sheet') }, out);
    let [y, width] = [8, 0];
    for (const panel of root.querySelectorAll('.panel')) {
      const plot = panel.querySelector(':scope > svg');
      const size = plot.viewBox.baseVal;
      let x = 62;
      const say = (text, weight) => {
        const element = svg('text', { x, y: y + 14, fill: style.color, 'font-weight': weight }, out, text);
        x += 7 * element.textContent.length + 14;
      };
      say(panel.querySelector('.axis').textContent, 400);
      for (const curve of panel.querySelectorAll('.curve')) {
        const key = plain(curve.querySelector('svg'));
        key.setAttribute('x', x);
        key.setAttribute('y', y + 5);
        out.append(key);
        x += 26;
        say(curve.querySelector('svg + span').textContent, 400);
      }
      const copy = plain(plot);
      for (const [name, value] of [['x', 0], ['y', y + 22], ['width', size.width], ['height', size.height]]) copy.setAttribute(name, value);
      out.append(copy);
      y += 26 + size.height;
      width = Math.max(width, size.width, x);
    }
    for (const [name, value] of [['width', width], ['height', y], ['viewBox', `0 0 ${width} ${y}`]]) out.setAttribute(name, value);
    ground.setAttribute('width', width);
    ground.setAttribute('height', y);
    return new XMLSerializer().serializeToString(out);
  }

  // Rows of runs between two times: `runs` are { label, time, columns: [{ name, unit, at }] } with the value of each row.
  function table(runs, [from, to]) {
    const quoted = text => /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
    const several = runs.length > 1;
    const names = runs[0].columns.map(c => quoted(c.unit ? `${c.name} [${c.unit}]` : c.name));
    const lines = [[...several ? ['run'] : [], 'time [s]', ...names].join(',')];
    for (const run of runs) {
      for (let k = 0; k < run.time.length; k++) {
        if (run.time[k] < from || run.time[k] > to) continue;
        lines.push([...several ? [quoted(run.label)] : [], run.time[k], ...run.columns.map(c => c.at(k))].join(','));
      }
    }
    return lines.join('\n') + '\n';
  }

  return { offer, picture, table };
})();
