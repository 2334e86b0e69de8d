// The spool moving in its housing: seals, control edges, chambers coloured by their pressure, and air
// through the gaps that are open. Not to scale: along the axis the stroke is enlarged.
mocc.machine = (root, spool, data, value, column, heard) => {
  const { svg, html } = mocc;
  const PITCH = 104, STROKE = 46, ROD = 15, PISTON = 29, BORE = 35, GROOVE = 54, END = 44, RUN = 10;
  const n = spool.seals.length;
  const BODY = n > 0 ? 82 : 58;
  const [low, high] = spool.stops;
  const shift = s => STROKE * (s - low) / (high - low);
  const seat = k => END + 46 + k * PITCH;
  const width = n > 0 ? seat(n - 1) + STROKE + 46 + END : 2 * END + 420;
  const left = END, right = width - END;
  const uid = 'spool-clip';

  // ---- Controls ----

  const bar = html('div', { class: 'toolbar' }, root);
  const play = html('button', { 'aria-label': 'play' }, bar, '▶ play');
  const slider = html('input', { type: 'range', min: 0, max: 1, step: 0.0005, value: 0, 'aria-label': 'time' }, bar);
  const output = html('output', {}, bar);
  let run = data.runs[0];
  if (data.runs.length > 1) {
    const choice = html('select', { 'aria-label': 'run' }, bar);
    data.runs.forEach((r, k) => html('option', { value: k }, choice, r.label));
    choice.addEventListener('change', () => { run = data.runs[choice.value]; draw(now); });
  }

  // ---- What stands still ----

  const middle = BODY + 44;
  // The scale of the pressure stands beside that of the stroke, or below it.
  const narrow = width < 720;
  // Names of pistons and springs stand above their end, or below where a chamber has its name there; the scale makes room.
  const drives = spool.drives.filter(d => d.chamber === null);
  const isBelow = d => n > 0 && spool.seals[d.right ? n - 1 : 0][d.right ? 'right' : 'left'] !== null;
  const lowered = drives.some(isBelow) ? 18 : 0;
  const picture = svg('svg', { viewBox: `0 0 ${width} ${2 * middle + (narrow ? 52 : 30) + lowered}`, role: 'img', 'aria-label': 'spool in its housing' }, root);
  picture.style.maxWidth = `${1.25 * width}px`;
  const hatch = svg('pattern', { id: 'spool-hatch', width: 7, height: 7, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)' }, svg('defs', {}, picture));
  svg('rect', { width: 7, height: 7, fill: '#e9ecef' }, hatch);
  svg('path', { d: 'M0 0V7', stroke: '#b9c1c9', 'stroke-width': 1.5 }, hatch);
  const scene = svg('g', { transform: `translate(0 ${middle})` }, picture);

  // Where each seal has its land: the bore is narrow there. A seal that never touches has none.
  const lands = spool.seals.map((seal, k) => {
    const x = seat(k), edge = x + shift(seal.edge);
    switch (seal.touches) {
      case 'below': return [x - RUN, edge];
      case 'above': return [edge, x + STROKE + RUN];
      case 'always': return [x - RUN, x + STROKE + RUN];
      default: return null;
    }
  });

  // The contour of the bore above the axis; that below is its mirror image.
  function contour(sign) {
    let path = `M${left} ${-sign * GROOVE}`;
    for (const land of lands.filter(l => l)) {
      const [a, b] = land;
      path += `L${a - 4} ${-sign * GROOVE}L${a} ${-sign * BORE}L${b} ${-sign * BORE}L${b + 4} ${-sign * GROOVE}`;
    }
    return path + `L${right} ${-sign * GROOVE}`;
  }
  const inside = n > 0
    ? `${contour(1)}L${right} ${GROOVE}${contour(-1).slice(1).split('L').reverse().map(p => `L${p}`).join('')}Z`
    : `M${left} ${-BORE}H${right}V${BORE}H${left}Z`;
  svg('path', { d: inside }, svg('clipPath', { id: uid }, scene));
  svg('rect', { x: left - 14, y: -BODY, width: right - left + 28, height: 2 * BODY, rx: 6, fill: 'url(#spool-hatch)', stroke: '#5b6470' }, scene);

  svg('path', { d: inside, fill: '#ffffff' }, scene);

  // ---- Chambers: between seals, and at the ends ----

  const pressures = spool.chambers.map(c => c.p).concat(spool.drives.map(d => d.p)).filter(p => p !== null);
  let [lowest, highest] = [Infinity, -Infinity];
  for (const r of data.runs) {
    for (const p of pressures) {
      const all = column(r, p);
      for (const v of all) [lowest, highest] = [Math.min(lowest, v), Math.max(highest, v)];
    }
  }
  const hasPressure = highest >= lowest;
  // From nearly white to blue, even in lightness.
  function tint(p) {
    const x = highest > lowest ? (p - lowest) / (highest - lowest) : 0.5;
    const mix = (a, b) => Math.round(a + (b - a) * x);
    return `rgb(${mix(238, 52)} ${mix(245, 134)} ${mix(250, 196)})`;
  }

  const air = svg('g', { 'clip-path': `url(#${uid})` }, scene);
  const rooms = [];
  for (let k = 0; k <= n && n > 0; k++) {
    const before = k > 0 ? spool.seals[k - 1].right : null;
    const after = k < n ? spool.seals[k].left : null;
    const split = k > 0 && k < n && before !== after;
    const from = k > 0 ? lands[k - 1]?.[1] ?? seat(k - 1) + STROKE : left;
    const to = k < n ? lands[k]?.[0] ?? seat(k) : right;
    const wall = (Math.max(from, left) + Math.min(to, right)) / 2;
    const add = (chamber, half) => rooms.push({ k, chamber, half, wall, rect: svg('rect', { y: -GROOVE, height: 2 * GROOVE }, air) });
    if (split) { add(before, 'left'); add(after, 'right'); } else { add(k > 0 ? before : after, null); }
    if (split) svg('path', { d: `M${wall} ${-GROOVE}V${-ROD}M${wall} ${ROD}V${GROOVE}`, stroke: '#5b6470', 'stroke-width': 3 }, scene);
    // The port through the housing, with its name.
    const chamber = spool.chambers[split ? before ?? after : k > 0 ? before : after];
    if (chamber) {
      const x = k === 0 ? left + 17 : k === n ? right - 17 : wall;
      if (!split && chamber.ports.length > 0) {
        rooms[rooms.length - 1].port = svg('rect', { x: x - 8, y: -BODY - 6, width: 16, height: BODY - GROOVE + 8 }, scene);
        svg('path', { d: `M${x - 8} ${-BODY - 6}V${-GROOVE}M${x + 8} ${-BODY - 6}V${-GROOVE}`, stroke: '#5b6470' }, scene);
      }
      svg('text', { x, y: -BODY - 27, 'text-anchor': 'middle', 'font-weight': 600 }, scene, chamber.name);
      const ports = chamber.ports.join(', ');
      const size = Math.min(11, 11 * (PITCH - 6) / Math.max(1, ports.length * 5.6));
      const line = svg('text', { x, y: -BODY - 13, 'text-anchor': 'middle', fill: '#5b6470', 'font-size': size }, scene, ports);
      line.style.fontSize = `${size}px`;
    }
  }

  // ---- What drives it: pistons and springs that no seal bounds ----

  const ends = drives.map(d => {
    const room = d.piston ? svg('rect', { y: -GROOVE, height: 2 * GROOVE }, air) : null;
    const spring = d.piston ? null : svg('path', { fill: 'none', stroke: '#3c4650', 'stroke-width': 2.2 }, scene);
    svg('text', { x: d.right ? right + 12 : left - 12, y: isBelow(d) ? BODY + 50 : -BODY - 14, 'text-anchor': d.right ? 'end' : 'start', 'font-weight': 600 }, scene, d.name);
    return { d, room, spring };
  });

  // ---- What moves ----

  const moving = svg('g', { class: 'moving' }, scene);
  const first = n > 0 ? seat(0) : left + 110;
  const last = n > 0 ? seat(n - 1) : right - 110 - STROKE;
  svg('rect', { x: first - 22, y: -ROD, width: last - first + 44, height: 2 * ROD, fill: '#cfd6dd', stroke: '#3c4650' }, moving);
  const rings = spool.seals.map((seal, k) => {
    const x = seat(k);
    const group = svg('g', { class: 'seal', 'data-seal': seal.name }, moving);
    svg('title', {}, group, `${seal.name}: ${seal.description}\n${seal.contact}, edge at ${mocc.number(1e3 * seal.edge)} mm`);
    svg('rect', { x: x - 9, y: -PISTON, width: 18, height: 2 * PISTON, rx: 2, fill: '#cfd6dd', stroke: '#3c4650' }, group);
    return [-1, 1].map(side => svg('ellipse', { cx: x, cy: side * (PISTON + 1), rx: 6, ry: 5.5, stroke: '#1a1a1a', 'stroke-width': 1.4 }, group));
  });
  if (n === 0) {
    for (const x of [first, last]) svg('rect', { x: x - 12, y: -BORE + 2, width: 24, height: 2 * BORE - 4, rx: 3, fill: '#cfd6dd', stroke: '#3c4650' }, moving);
  }
  const front = svg('g', {}, scene);
  svg('path', { d: inside, fill: 'none', stroke: '#5b6470', 'stroke-width': 1.2 }, front);
  svg('path', { d: `M${left - 10} 0H${right + 10}`, stroke: '#8a939e', 'stroke-dasharray': '12 4 2 4', 'stroke-width': 0.8 }, front);
  const arrows = spool.seals.map(() => svg('path', { fill: 'none', stroke: '#003d66', 'stroke-linecap': 'round', 'stroke-linejoin': 'round' }, front));
  spool.seals.forEach((seal, k) => {
    svg('text', { x: seat(k) + STROKE / 2, y: BODY + 18, 'text-anchor': 'middle', 'font-weight': 600 }, scene, seal.name);
  });
  const states = spool.seals.map((seal, k) => svg('text', { x: seat(k) + STROKE / 2, y: BODY + 33, 'text-anchor': 'middle' }, scene));

  // Stops: the range of the stroke below the housing, with a pointer.
  const scaleY = BODY + 52 + lowered;
  const scaleX = width / 2 - (narrow ? 110 : 150);
  svg('path', { d: `M${scaleX} ${scaleY - 5}V${scaleY + 5}M${scaleX} ${scaleY}H${scaleX + 220}M${scaleX + 220} ${scaleY - 5}V${scaleY + 5}`, stroke: '#5b6470' }, scene);
  svg('text', { x: scaleX - 8, y: scaleY + 4, 'text-anchor': 'end' }, scene, `${mocc.number(1e3 * low)} mm`);
  svg('text', { x: scaleX + 228, y: scaleY + 4 }, scene, `${mocc.number(1e3 * high)} mm`);
  const needle = svg('path', { d: 'M0 0L-5 -9H5Z', fill: '#1a1a1a' }, scene);
  if (hasPressure) {
    const gradient = svg('linearGradient', { id: 'spool-scale' }, svg('defs', {}, picture));
    svg('stop', { offset: 0, 'stop-color': tint(lowest) }, gradient);
    svg('stop', { offset: 1, 'stop-color': tint(highest) }, gradient);
    const [gx, gy] = narrow ? [width / 2 - 50, scaleY + 24] : [width / 2 + 190, scaleY];
    svg('rect', { x: gx, y: gy - 6, width: 100, height: 11, fill: 'url(#spool-scale)', stroke: '#8a939e' }, scene);
    svg('text', { x: gx - 6, y: gy + 4, 'text-anchor': 'end' }, scene, mocc.number(lowest / 1e5, 3));
    svg('text', { x: gx + 106, y: gy + 4 }, scene, `${mocc.number(highest / 1e5, 3)} bar`);
  }

  // The greatest flow through a seal: the widest arrow.
  let most = 0;
  for (const r of data.runs) {
    for (const seal of spool.seals) {
      if (seal.flow === null) continue;
      for (const v of column(r, seal.flow)) most = Math.max(most, Math.abs(v));
    }
  }

  // ---- The picture at a time ----

  let now = run.ends[0];
  function draw(t) {
    const s = value(run, spool.s, t);
    const dx = shift(s);
    moving.setAttribute('transform', `translate(${dx.toFixed(2)} 0)`);
    needle.setAttribute('transform', `translate(${scaleX + 220 * dx / STROKE} ${scaleY - 1})`);
    for (const room of rooms) {
      let a = room.k > 0 ? seat(room.k - 1) + dx : left;
      let b = room.k < n ? seat(room.k) + dx : right;
      if (room.half === 'left') b = room.wall;
      if (room.half === 'right') a = room.wall;
      room.rect.setAttribute('x', a);
      room.rect.setAttribute('width', Math.max(0, b - a));
      const p = room.chamber === null ? null : spool.chambers[room.chamber].p;
      const fill = p === null ? '#ffffff' : tint(value(run, p, t));
      room.rect.setAttribute('fill', fill);
      room.port?.setAttribute('fill', fill);
    }
    for (const { d, room, spring } of ends) {
      const head = d.right ? last + dx + (n > 0 ? 22 : 12) : first + dx - (n > 0 ? 22 : 12);
      if (room) {
        room.setAttribute('x', d.right ? head : left);
        room.setAttribute('width', Math.max(0, d.right ? right - head : head - left));
        room.setAttribute('fill', tint(value(run, d.p, t)));
      } else {
        const [a, b] = d.right ? [head, right] : [left, head];
        let path = `M${a} 0`;
        for (let i = 0; i < 12; i++) path += `L${a + (b - a) * (i + 0.5) / 12} ${i % 2 ? 11 : -11}`;
        spring.setAttribute('d', `${path}L${b} 0`);
      }
    }
    spool.seals.forEach((seal, k) => {
      const x = seat(k) + dx;
      const closed = seal.closed === null ? lands[k] && x >= lands[k][0] && x <= lands[k][1] : value(run, seal.closed, t) > 0.5;
      for (const ring of rings[k]) ring.setAttribute('fill', closed ? '#1a1a1a' : '#ffffff');
      const opening = seal.opening === null ? 0 : value(run, seal.opening, t);
      const tells = seal.opening !== null && opening > 0.005;
      states[k].textContent = tells ? `${Math.round(100 * opening)} % open` : closed ? 'closed' : 'free';
      const flow = seal.flow === null ? 0 : value(run, seal.flow, t) * (seal.turned ? -1 : 1);
      const share = most > 0 ? Math.abs(flow) / most : 0;
      // An arrow on both sides of the axis, past the ring.
      if (share > 0.002) {
        const to = flow > 0 ? 1 : -1;
        const y = (BORE + PISTON) / 2 + 10;
        const one = sign => `M${x - 22 * to} ${sign * (y + 2)}Q${x} ${sign * (y - 3)} ${x + 20 * to} ${sign * (y + 2)}` +
          `m${-6 * to} -5l${6 * to} 5l${-6 * to} 5`;
        arrows[k].setAttribute('d', one(1) + one(-1));
        arrows[k].setAttribute('stroke-width', (1 + 3.5 * Math.sqrt(share)).toFixed(2));
        arrows[k].setAttribute('visibility', 'visible');
      } else {
        arrows[k].setAttribute('visibility', 'hidden');
      }
    });
    output.textContent = `${mocc.number(mocc.shown(t, data.time), 5)} ${data.time.unit},  s = ${mocc.number(1e3 * s, 5)} mm`;
  }

  function go(t) {
    now = t;
    slider.value = (t - run.ends[0]) / (run.ends[1] - run.ends[0]);
    draw(t);
  }

  slider.addEventListener('input', () => {
    now = run.ends[0] + Number(slider.value) * (run.ends[1] - run.ends[0]);
    draw(now);
    heard(now);
  });

  // The whole run in twelve seconds.
  let playing = null;
  play.addEventListener('click', () => {
    if (playing !== null) { cancelAnimationFrame(playing); playing = null; play.textContent = '▶ play'; return; }
    play.textContent = '❚❚ pause';
    const [a, b] = run.ends;
    if (now >= b) now = a;
    let before = performance.now();
    const frame = time => {
      now = Math.min(b, now + (b - a) * (time - before) / 12000);
      before = time;
      go(now);
      heard(now);
      if (now < b) playing = requestAnimationFrame(frame);
      else { playing = null; play.textContent = '▶ play'; }
    };
    playing = requestAnimationFrame(frame);
  });

  go(run.ends[0]);
  return { go, slider, moving, spool };
};
