// The drawing as SVG: made anew when the structure changes, only moved while it moves. Also what lies under a pointer.
const SVG = "http://www.w3.org/2000/svg";
const NEAR_PIN = 12, NEAR_BAR = 9, MARGIN = 70, LETTER = 13;

const made = (name, attributes, parent) => {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  parent?.append(node);
  return node;
};
const colour = (k) => (k === null || k === undefined ? "" : ` c${k === 0 ? 0 : ((k - 1) % 7) + 1}`);
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

const toSegment = (p, a, b) => {
  const x = b[0] - a[0], y = b[1] - a[1], long = x * x + y * y;
  const t = long ? Math.max(0, Math.min(1, ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / long)) : 0;
  return distance(p, [a[0] + t * x, a[1] + t * y]);
};
const isInside = (p, corners) => corners.reduce((odd, [x, y], k) => {
  const [u, v] = corners[(k + corners.length - 1) % corners.length];
  return (y > p[1]) !== (v > p[1]) && p[0] < ((u - x) * (p[1] - y)) / (v - y) + x ? !odd : odd;
}, false);

export class Canvas {
  constructor(svg) {
    this.svg = svg;
    this.view = { scale: 4, x: 0, y: 0 };
    this.structure = null;
    this.motion = null;
    this.pose = null;
    this.moved = {};
    this.layers = ["traces", "guides", "links", "marks", "pins", "letters", "above"];
    for (const name of this.layers) this[name] = made("g", { class: `layer-${name}` }, svg);
    new ResizeObserver(() => this.draw()).observe(svg);
  }

  get size() { return [this.svg.clientWidth || 1, this.svg.clientHeight || 1]; }

  // from the plane of the mechanism, y up, to the screen and back
  screen([x, y]) {
    const [wide, high] = this.size, { scale } = this.view;
    return [wide / 2 + (x - this.view.x) * scale, high / 2 - (y - this.view.y) * scale];
  }

  plane([x, y]) {
    const [wide, high] = this.size, { scale } = this.view;
    return [this.view.x + (x - wide / 2) / scale, this.view.y - (y - high / 2) / scale];
  }

  // a place as it is written: a whole number of steps, each a few pixels at most
  rounded([x, y]) {
    const digits = -Math.floor(Math.log10(2 / this.view.scale)), by = 10 ** digits;
    return [x, y].map((one) => Number((Math.round(one * by) / by).toFixed(Math.max(0, digits))));
  }

  fit() {
    const points = Object.values(this.structure?.points ?? {});
    for (const [xs, ys] of Object.values(this.motion?.points ?? {})) {
      xs.forEach((x, k) => { if (x !== null && k % 6 === 0) points.push([x, ys[k]]); });
    }
    if (points.length < 2) return;
    const [xs, ys] = [0, 1].map((k) => points.map((one) => one[k]));
    const [left, right, low, top] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const [wide, high] = this.size;
    const scale = Math.min((wide - 2 * MARGIN) / (right - left || 1), (high - 2 * MARGIN) / (top - low || 1));
    this.view = { scale: Math.max(scale, 1e-6), x: (left + right) / 2, y: (low + top) / 2 };
    this.draw();
  }

  zoom(factor, at) {
    const [x, y] = this.plane(at);
    this.view.scale = Math.min(1e9, Math.max(1e-9, this.view.scale * factor));
    const [u, v] = this.plane(at);
    this.view.x += x - u;
    this.view.y += y - v;
    this.draw();
  }

  pan(by) {
    this.view.x -= by[0] / this.view.scale;
    this.view.y += by[1] / this.view.scale;
    this.draw();
  }

  isShown(k) { return Boolean(this.motion?.assembled[k]); }

  place(letter) {
    if (this.moved[letter]) return this.moved[letter];
    const moving = this.pose === null ? null : this.motion?.points[letter];
    return moving && moving[0][this.pose] !== null ? [moving[0][this.pose], moving[1][this.pose]] : this.structure?.points[letter];
  }

  at(letter) {
    const place = this.place(letter);
    return place && this.screen(place);
  }

  angle(link) {
    const own = this.pose === null ? null : this.motion?.origins[link];
    return own ? own[2][this.pose] : this.structure.angles[link] ?? 0;
  }

  // the point of the driven link by which the driver is dragged
  get handle() {
    const drive = this.structure?.drives[0], link = this.structure?.links.find((one) => one.name === drive?.link);
    if (!link || !this.motion?.poses) return null;
    const pivot = this.place(drive.points[0]);
    const others = drive.is_angle ? link.points.filter((one) => !drive.points.includes(one)) : link.points;
    const away = (one) => (pivot && this.place(one) ? distance(pivot, this.place(one)) : -1);
    return others.sort((a, b) => away(b) - away(a))[0] ?? null;
  }

  // what lies under a place of the screen: a point, else a link, else nothing
  under(at, reach = 1, but = []) {
    let best = null, near = NEAR_PIN * reach;
    for (const letter of Object.keys(this.structure?.points ?? {})) {
      const there = but.includes(letter) ? null : this.at(letter);
      if (there && distance(at, there) <= near) [best, near] = [{ point: letter }, distance(at, there)];
    }
    if (best) return best;
    near = NEAR_BAR * reach;
    for (const { name, points } of this.structure?.links ?? []) {
      if (name === "frame" || points.some((one) => but.includes(one))) continue;
      const corners = points.map((one) => this.at(one)).filter(Boolean);
      corners.forEach((corner, k) => {
        if (k && toSegment(at, corners[k - 1], corner) <= near) [best, near] = [{ link: name }, toSegment(at, corners[k - 1], corner)];
      });
      if (corners.length > 2 && (isInside(at, corners) || toSegment(at, corners.at(-1), corners[0]) <= near)) best ??= { link: name };
    }
    return best;
  }

  show(structure) {
    this.structure = structure;
    this.draw();
  }

  draw() {
    for (const name of this.layers) if (name !== "above") this[name].replaceChildren();
    if (!this.structure) return;
    const { links, pins, pairs, faults } = this.structure;
    const wrong = new Set(faults.filter((one) => one.what.includes("too many")).flatMap((one) => one.links));
    this.#traces();
    for (const pair of pairs) this.#pair(pair);
    for (const link of links) {
      const corners = link.points.map((one) => this.at(one)).filter(Boolean);
      if (link.name === "frame") {
        corners.forEach((one) => this.#ground(one));
      } else if (corners.length > 1) {
        const classes = `link${colour(link.colour)}${link.is_aside ? " aside" : ""}${corners.length > 2 ? " plate" : ""}`;
        const isOver = this.over?.link === link.name || this.chosen?.link === link.name;
        const path = `M${corners.map((one) => one.map((n) => n.toFixed(2)).join(" ")).join("L")}${corners.length > 2 ? "Z" : ""}`;
        made("path", { d: path, class: `${classes}${isOver ? " over" : ""}${wrong.has(link.name) ? " bad" : ""}`, "data-link": link.name }, this.links);
      }
    }
    this.#drives();
    for (const letter of Object.keys(this.structure.points)) {
      const at = this.at(letter);
      if (!at) continue;
      const state = `${this.over?.point === letter ? " over" : ""}${this.chosen?.point === letter ? " chosen" : ""}`;
      made("circle", { cx: at[0], cy: at[1], r: pins[letter] ? 5.5 : 4, class: `pin${pins[letter] ? "" : " end"}${state}`, "data-point": letter }, this.pins);
      made("text", { x: at[0] + LETTER, y: at[1] - LETTER + 3 }, this.letters).textContent = letter;
    }
  }

  // the paths of points that only one moving link has, and of the one that is chosen
  #traces() {
    if (!this.motion?.poses) return;
    const frame = this.structure.links.find((one) => one.name === "frame")?.points ?? [];
    for (const [letter, [xs, ys]] of Object.entries(this.motion.points)) {
      if (frame.includes(letter) || (this.structure.pins[letter] && this.chosen?.point !== letter)) continue;
      let path = "", pen = "M";
      xs.forEach((x, k) => {
        if (x === null) { pen = "M"; return; }
        const at = this.screen([x, ys[k]]);
        path += `${pen}${at[0].toFixed(1)} ${at[1].toFixed(1)}`;
        pen = "L";
      });
      if (path) made("path", { d: path, class: "trace" }, this.traces);
    }
  }

  #ground([x, y]) {
    const lines = [-12, -6, 0, 6, 12].map((k) => `M${x + k} ${y + 16}l-5 7`).join("");
    made("path", { d: `M${x} ${y}l-11 16h22Z M${x - 15} ${y + 16}h30${lines}`, class: "ground" }, this.marks);
  }

  #pair(pair) {
    const places = pair.points.map((one) => this.at(one)).filter(Boolean);
    if (pair.guide && places.length > 1) {
      const [on] = pair.links, turned = -(this.angle(on) + pair.guide[2]), degrees = (turned * 180) / Math.PI;
      const [x, y] = places[0], [ux, uy] = [Math.cos(turned), Math.sin(turned)];
      const far = Math.max(60, distance(places[0], places[1]) + 40);
      if (on === "frame") made("path", { d: `M${x - far * ux} ${y - far * uy}L${x + far * ux} ${y + far * uy}`, class: "guide" }, this.guides);
      if (pair.code === "P") made("rect", { x: -15, y: -9, width: 30, height: 18, rx: 2, class: "block", transform: `translate(${x} ${y}) rotate(${degrees})` }, this.marks);
    } else if (places.length > 1) {
      made("path", { d: `M${places.map((one) => one.join(" ")).join("L")}`, class: "tie" }, this.guides);
    }
  }

  #drives() {
    for (const drive of this.structure.drives) {
      const at = this.at(drive.points[0]);
      if (!at) continue;
      const [x, y] = at;
      const arrow = drive.is_angle
        ? `M${x - 7} ${y - 22}A23 23 0 0 0 ${x - 7} ${y + 22}m-8 1l8 -1l-2 -8`
        : `M${x - 22} ${y - 20}h44m-7 -5l7 5l-7 5m-30 -10l-7 5l7 5`;
      made("path", { d: arrow, class: "turns" }, this.marks);
    }
    const at = this.handle && this.at(this.handle);
    if (at) made("circle", { cx: at[0], cy: at[1], r: 12, class: "handle" }, this.marks);
  }

  // what a gesture shows above the drawing: the bar to be, the ring around what would be joined
  sketch(from, to, ring) {
    this.above.replaceChildren();
    if (from && to) made("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], class: "rubber" }, this.above);
    if (ring) made("circle", { cx: ring[0], cy: ring[1], r: 15, class: "ring" }, this.above);
  }
}
