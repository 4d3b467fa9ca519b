// What plots run along: the time, the driver or the poses, with the jumps of the motion.
(() => {
  "use strict";
  const page = window.compoundkin;
  const TURNS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720, 1080, 3600];
  const SAME = 1e-7; // both sides of a jump are one place

  page.plotAxis = (player) => {
    const { along } = player, last = player.poses - 1, extra = player.data.plots ?? {};
    // uPlot wants numbers that only grow along x; a driver that goes back and forth is drawn over the poses
    const grows = (values) => values.every((value, k) => k === 0 || value > values[k - 1]);
    const turned = last > 0 && grows([...along.values].reverse());
    const known = last > 0 && (grows(along.values) || turned);
    const order = [...along.values.keys()];
    if (turned) order.reverse();
    const xs = known ? order.map((k) => along.values[k]) : order;
    // how fast it runs, where that is known and never zero
    player.pace = known && extra.rate != null ? page.unpacked(extra.rate, player.poses) : null;
    return {
      known, order, xs,
      name: known ? along.name : "poses",
      label: known ? `${along.name}${along.unit ? ` [${page.raised(along.unit)}]` : ""}` : "pose",
      range: xs[0] === xs[last] ? [xs[0] - 1, xs[0] + 1] : [xs[0], xs[last]],
      incrs: known && along.unit === "deg" ? { incrs: TURNS } : {},
      at: (k) => (known ? along.values[k] : k),
      // the jumps in the order in which they are drawn; `isOwn` where the values that came with the page hold
      jumps: (name, part, isOwn) => (extra.jumps ?? []).map(({ place, begins, values }) => {
        const on = turned ? last - place : place, k = Math.min(Math.floor(on), last - 1);
        const y = isOwn && values[name] ? values[name][part] : null;
        return { place: on, begins: begins !== turned, x: xs[k] + (on - k) * (xs[k + 1] - xs[k]), y };
      }).sort((a, b) => (Math.abs(a.place - b.place) > SAME ? a.place - b.place : a.begins - b.begins)),
    };
  };
})();
