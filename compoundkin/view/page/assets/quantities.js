// Quantities of a motion by their names: those that came with the page, and those of any point or link.
(() => {
  "use strict";
  const page = window.compoundkin;
  const DEGREE = 180 / Math.PI;
  const ROUNDING = 3e-7; // rates are packed with seven digits: what is smaller beside the largest of them is rounding
  const OF_POINTS = ["position", "velocity", "acceleration"];
  const OF_LINKS = ["angle", "angular_velocity", "angular_acceleration"];
  const PER = ["", "/s", "/s^2"];

  const parsed = (name) => [name.slice(0, name.lastIndexOf(".")), name.slice(name.lastIndexOf(".") + 1)];

  const ofPoint = (player, letter, order) => {
    const pairs = Array.from({ length: player.poses }, (_, k) => (order ? player.rate(letter, order, k) : player.place(letter, k)));
    return { x: pairs.map((p) => p[0]), y: pairs.map((p) => p[1]) };
  };
  const ofLink = (link, order) => ({ "": order ? (order === 1 ? link.v : link.a)?.[2] : Array.from(link.angle, (a) => a * DEGREE) });

  // the parts of a point's or link's quantity, and of what it changes by: null where that is not known
  const known = (player, name, more = 0) => {
    const [owner, word] = parsed(name);
    const link = player.links.find((one) => one.name === owner);
    const [words, is] = link && OF_LINKS.includes(word) ? [OF_LINKS, "angle"] : [OF_POINTS, "length"];
    const order = words.indexOf(word) + more;
    if (!words.includes(word) || order > Math.min(2, player.data.order) || (is === "length" && !player.points[owner])) return null;
    const parts = is === "angle" ? ofLink(link, order) : ofPoint(player, owner, order);
    return { order, is, parts };
  };
  const mapped = (parts, f) => Object.fromEntries(Object.entries(parts).map(([name, values]) => [name, Array.from(values, f)]));
  const largest = (parts) => Object.values(parts).reduce((all, values) => values.reduce((most, v) => (Math.abs(v) > most ? Math.abs(v) : most), all), 0);

  const made = (player, name) => {
    const { order, is, parts } = known(player, name);
    const unit = is === "angle" ? (order ? `rad${PER[order]}` : "deg") : `${player.data.unit}${PER[order]}`;
    const floor = player.data.plots ? player.data.plots.rounding[is][order] : 0;
    return { name, unit, order, floor: Math.max(floor, order ? ROUNDING * largest(parts) : floor), parts };
  };
  // by how much it changes along the axis: by the rates of the same point or link, and the pace of the axis
  const slopes = (player, { name, unit, parts }) => {
    const found = player.pace && known(player, name, 1);
    if (!found || Object.keys(parts).join() !== Object.keys(found.parts).join()) return {};
    const turn = unit === "deg" ? DEGREE : 1;
    return mapped(found.parts, (rate, k) => (rate * turn) / player.pace[k]);
  };

  // A quantity with the length of a rate, which says more than its parts; that of a position says nothing.
  page.quantity = (player, name) => {
    const quantity = player.outputs.find((one) => one.name === name) ?? made(player, name);
    const floor = quantity.floor ?? 0;
    const parts = mapped(quantity.parts, (value) => (Math.abs(value) <= floor ? 0 : value));
    if (parts.x && quantity.order > 0) parts.length = parts.x.map((x, k) => Math.hypot(x, parts.y[k]));
    return { ...quantity, floor, parts, slopes: slopes(player, quantity) };
  };
})();
