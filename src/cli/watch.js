(() => {
  const KEY = 'mocc-watch';
  const kept = JSON.parse(sessionStorage.getItem(KEY) ?? 'null');
  const m = window.__mocc;
  if (kept && m) {
    const known = kept.chosen.map(n => m.byName.get(n)).filter(k => k !== undefined);
    if (known.length > 0) m.chosen.splice(0, m.chosen.length, ...known);
    m.layout.value = kept.layout;
    m.update();
    if (kept.view) m.figure.zoom(kept.view);
    if (kept.cursor !== null) m.go(Math.min(kept.cursor, m.figure.whole[1]));
    window.scrollTo(0, kept.scroll);
  }
  setInterval(async () => {
    try {
      const answer = await fetch('/version', { cache: 'no-store' });
      if ((await answer.text()) === version) return;
    } catch { return; }
    if (m) {
      const whole = m.figure.view.join() === m.figure.whole.join();
      sessionStorage.setItem(KEY, JSON.stringify({
        chosen: m.chosen.map(k => m.data.variables[k].name), layout: m.layout.value, view: whole ? null : m.figure.view,
        cursor: m.figure.cursor, scroll: window.scrollY,
      }));
    }
    location.reload();
  }, 500);
})();
