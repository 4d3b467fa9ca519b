// Plots over the driver or the time, whose cursor is the pose that the sketch shows: drag it, and the sketch follows.
(() => {
  "use strict";
  const page = window.compoundkin;
  const [player] = page.players ?? [];
  const place = document.querySelector(".plots");
  if (!player || !place) return;
  const axis = page.plotAxis(player), { signal } = player;
  const SLICE = 4; // milliseconds of drawing for one picture of the screen
  const { known } = axis;

  // --- extremes that the page tells, found between the poses: those of the design it was made of -----------------------
  const extremes = new Map([...document.querySelectorAll("tr[data-figure]")].flatMap((row) => {
    const [kind, name] = JSON.parse(row.dataset.figure);
    const [low, , high] = [...row.cells].slice(-4), ends = [low, high].map((cell) => {
      const [y, x] = [cell, cell.nextElementSibling].map((one) => Number(one.dataset.sort ?? one.textContent));
      return { x, y };
    });
    return kind === "range" ? [[name, ends.filter(({ x, y }) => known && Number.isFinite(x) && Number.isFinite(y))]] : [];
  }));

  const panels = [];
  const remove = (panel) => {
    panels.splice(panels.indexOf(panel), 1);
    place.querySelector(".quantity").focus();
  };
  const add = (name, removable) => {
    panels.push(new page.PlotPanel(name, { player, axis, place, extremes, remove: removable ? remove : null }));
    seen.observe(panels.at(-1).figure);
    return panels.at(-1);
  };
  const follow = () => panels.forEach((panel) => panel.follow(player.pose));
  // where only the numbers change, the plots are told of it below
  let pose = player.pose;
  player.listeners.push((k) => {
    if (k === pose) return;
    pose = k;
    follow();
  });
  // a changed design is drawn where it is seen, as many plots as one picture of the screen has time for, then the next
  // ones; elsewhere when it comes into sight
  const waiting = () => panels.filter(({ isBehind, isSeen }) => isBehind && isSeen).sort((a, b) => a.order - b.order);
  let next = 0;
  const refresh = () => {
    next = 0;
    const begun = performance.now(), [first, ...others] = waiting();
    first?.refresh();
    for (const panel of others) {
      if (performance.now() - begun > SLICE) break;
      panel.refresh();
    }
    // who has waited is first then
    if (waiting().length) next = requestAnimationFrame(refresh);
  };
  const seen = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => {
    const panel = panels.find(({ figure }) => figure === target);
    if (!panel) return;
    panel.isSeen = isIntersecting;
    if (isIntersecting && panel.isBehind) panel.refresh();
  }), { rootMargin: "20%" });
  player.design?.on("change", () => {
    // those that still wait are drawn before those that were just drawn
    panels.forEach((panel) => { panel.order = panel.isBehind ? 0 : 1; panel.isBehind = true; });
    if (!next) refresh();
  });
  for (const output of player.outputs) add(output.name, false);
  const button = place.querySelector(".add");
  if (button) {
    button.addEventListener("click", () => add(place.querySelector(".quantity").value, true).figure.scrollIntoView({ block: "nearest" }), { signal });
  }

  // --- canvases follow the page: its width, its colours, paper ---------------------------------------------------------
  player.watch(new ResizeObserver(() => {
    panels.forEach((panel) => panel.fit());
    follow();
  }), place);
  const paint = () => {
    page.PlotPanel.recolour();
    for (const panel of panels) {
      if (panel.isBehind) panel.refresh();
      panel.plot.redraw();
    }
    follow();
  };
  document.addEventListener("compoundkin:theme", paint, { signal });
  matchMedia("print").addEventListener("change", paint, { signal });
  addEventListener("beforeprint", paint, { signal });
  addEventListener("afterprint", paint, { signal });
  player.atEnd(() => {
    cancelAnimationFrame(next);
    seen.disconnect();
    for (const { plot, figure } of panels.splice(0)) { plot.destroy(); figure.remove(); }
  });
  player.plots = { panels, add: (name) => add(name, true), settle: () => panels.filter(({ isBehind }) => isBehind).forEach((panel) => panel.refresh()) };
})();
