// Plots over the driver or the time, whose cursor is the pose that the sketch shows: drag it, and the sketch follows.
(() => {
  "use strict";
  const page = window.compoundkin;
  const [player] = page.players ?? [];
  const place = document.querySelector(".plots");
  if (!player || !place) return;
  const axis = page.plotAxis(player), { signal } = player;
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
  // a changed design is drawn at once where it is seen, elsewhere when it comes into sight
  const seen = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => {
    const panel = panels.find(({ figure }) => figure === target);
    if (!panel) return;
    panel.isSeen = isIntersecting;
    if (isIntersecting && panel.isBehind) panel.refresh();
  }), { rootMargin: "20%" });
  player.design?.on("change", () => panels.forEach((panel) => (panel.isSeen ? panel.refresh() : (panel.isBehind = true))));
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
    seen.disconnect();
    for (const { plot, figure } of panels.splice(0)) { plot.destroy(); figure.remove(); }
  });
  player.plots = { panels, add: (name) => add(name, true), settle: () => panels.filter(({ isBehind }) => isBehind).forEach((panel) => panel.refresh()) };
})();
