// The drawing as SVG: made anew when the structure changes, only moved while it moves. Also what lies under a pointer.
import { svgElement } from "./elements.js";

const NEAR_PIN = 12, NEAR_BAR = 9, MARGIN = 70;
// Directions in which a letter may stand about its point, the usual first, and how far from it; it leaves one when a
// bar comes nearer than HELD, in radians, and takes the first in which none is nearer than FREE.
const SIDES = [-1, -3, 0, 4, -2, 1, 3, 2].map((k) => (k * Math.PI) / 4), LETTER = 19, HELD = 0.4, FREE = 0.7;
// What is snapped to is so near, in pixels; two of them where they cross, so near.
const NEAR = 6, NEAR_CROSSING = 10;
const AWAY = 28, GUIDE = 70;
// Layers that are written when what is in them changes; all others at each picture.
const KEPT = ["below", "above"];

// A layer of the drawing. Each picture tells all its elements in order; those of the last one are used again.
class Layer {
  constructor(name, svg) {
    this.root = svgElement("g", { class: `layer-${name}` }, svg);
    this.held = [];
    this.used = 0;
  }

  begin() { this.used = 0; }

  put(name, attributes, text) {
    let one = this.held[this.used];
    if (one?.name !== name) {
      const node = svgElement(name, {});
      if (one) one.node.replaceWith(node);
      else this.root.append(node);
      one = this.held[this.used] = { name, node, attributes: {}, text: "" };
    }
    this.used += 1;
    for (const key in one.attributes) if (!(key in attributes)) one.node.removeAttribute(key);
    for (const key in attributes) if (one.attributes[key] !== attributes[key]) one.node.setAttribute(key, attributes[key]);
    if (text !== undefined && text !== one.text) one.node.textContent = one.text = text;
    one.attributes = attributes;
  }

  end() { for (const { node } of this.held.splice(this.used)) node.remove(); }
}

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

const plus = (a, b, by = 1) => [a[0] + by * b[0], a[1] + by * b[1]];
const unit = (a, b) => { const long = distance(a, b) || 1; return [(b[0] - a[0]) / long, (b[1] - a[1]) / long]; };
const dot = (a, b) => a[0] * b[0] + a[1] * b[1];

// What a place can be snapped to, in the plane: a line { at, along } or a circle { at, radius }; each with its words.
const nearest = (one, p) => {
  if (one.along) return plus(one.at, one.along, dot(plus(p, one.at, -1), one.along));
  return plus(one.at, unit(one.at, p), one.radius);
};
const onLine = (line, circle) => {
  const foot = nearest(line, circle.at), rest = circle.radius ** 2 - distance(foot, circle.at) ** 2;
  return rest < 0 ? [] : [1, -1].map((side) => plus(foot, line.along, side * Math.sqrt(rest)));
};
const crossings = (one, other) => {
  if (one.along && other.along) {
    const turn = one.along[0] * other.along[1] - one.along[1] * other.along[0], gap = plus(other.at, one.at, -1);
    return Math.abs(turn) < 1e-6 ? [] : [plus(one.at, one.along, (gap[0] * other.along[1] - gap[1] * other.along[0]) / turn)];
  }
  if (one.along) return onLine(one, other);
  if (other.along) return onLine(other, one);
  const gap = distance(one.at, other.at);
  if (!gap) return [];
  const along = unit(one.at, other.at), part = (gap ** 2 + one.radius ** 2 - other.radius ** 2) / (2 * gap);
  return onLine({ at: plus(one.at, along, part), along: [-along[1], along[0]] }, one);
};

export class Canvas {
  constructor(svg) {
    this.svg = svg;
    this.view = { scale: 4, x: 0, y: 0 };
    this.structure = null;
    this.motion = null;
    this.pose = null;
    this.moved = {};
    this.picked = new Set();
    this.toggled = new Set();
    this.locks = [];
    // where each letter stands: an index into SIDES
    this.sides = new Map();
    this.photo = null;
    this.layers = ["below", "traces", "guides", "shapes", "links", "marks", "pins", "letters", "above"];
    for (const name of this.layers) this[name] = KEPT.includes(name) ? svgElement("g", { class: `layer-${name}` }, svg) : new Layer(name, svg);
    // who changes what is drawn before it is, and who draws above it
    this.before = [];
    this.after = [];
    this.sized = new ResizeObserver(() => { this.measured = null; this.draw(); });
    this.sized.observe(svg);
  }

  unmount() {
    this.sized.disconnect();
    this.svg.replaceChildren();
  }

  // measured once: asked again after each change of the picture it would be laid out as often
  get size() { return this.measured ??= [this.svg.clientWidth || 1, this.svg.clientHeight || 1]; }

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
    // wheels, and profiles wherever they turn to
    const round = ({ line, ...shape }) => (line ? { ...shape, at: [0, 0], radius: Math.max(...line[0].map((x, k) => Math.hypot(x, line[1][k]))) } : shape);
    for (const { at, radius, link } of (this.structure?.pairs ?? []).flatMap((one) => one.shapes ?? []).map(round).filter((one) => one.radius)) {
      points.push(...[[1, 0], [-1, 0], [0, 1], [0, -1]].map((way) => plus(this.#inPlane(link)(at), way, radius)));
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
    // what is not known where it cannot be assembled is not drawn
    if (moving && moving[0][this.pose] === null && !this.isShown(this.pose)) return undefined;
    return moving && moving[0][this.pose] !== null ? [moving[0][this.pose], moving[1][this.pose]] : this.structure?.points[letter];
  }

  at(letter) {
    const place = this.place(letter);
    return place && this.screen(place);
  }

  // how a link lies: its origin and its angle. What a drawing does not show, such as a wheel, lies as where it begins.
  #lying(link) {
    const { origins, angles } = this.structure, k = this.pose ?? (origins[link] ? null : this.motion?.start);
    const own = k === null || k === undefined ? null : this.motion?.origins[link];
    if (own && own[0][k] !== null) return [[own[0][k], own[1][k]], own[2][k]];
    return [origins[link] ?? this.place(this.link(link)?.points[0]) ?? [0, 0], angles[link] ?? 0];
  }

  angle(link) { return this.#lying(link)[1]; }

  // the point of the driven link by which the driver is dragged
  get handle() {
    const drive = this.structure?.drives[0], fixed = this.frame;
    if (this.motion?.poses && this.cylinder(drive?.name)) return drive.points.find((one) => !fixed.includes(one)) ?? drive.points[0];
    const link = this.structure?.links.find((one) => one.name === drive?.link);
    if (!link || !this.motion?.poses) return null;
    const pivot = this.place(drive.points[0]);
    const others = drive.is_angle ? link.points.filter((one) => !drive.points.includes(one)) : link.points;
    const away = (one) => (pivot && this.place(one) ? distance(pivot, this.place(one)) : -1);
    return others.sort((a, b) => away(b) - away(a))[0] ?? null;
  }

  get frame() { return this.structure?.links.find((one) => one.name === "frame")?.points ?? []; }

  get allLetters() { return Object.keys(this.structure?.points ?? {}); }

  cylinder(name) { return this.structure?.pairs.find((one) => one.is_cylinder && one.name === name); }

  link(name) { return this.structure?.links.find((one) => one.name === name); }

  // the end of the chosen bar that can be drawn out, with the place of its handle, and the other end
  get drawn() {
    const link = this.link(this.chosen?.link), fixed = this.frame;
    if (!link || link.name === "frame" || link.points.length < 2) return null;
    const letter = link.points.toReversed().find((one) => !fixed.includes(one)) ?? link.points.at(-1);
    const from = link.points.find((one) => one !== letter && fixed.includes(one)) ?? link.points.find((one) => one !== letter);
    const [a, b] = [this.at(from), this.at(letter)];
    return a && b && distance(a, b) > 1 ? { link: link.name, letter, from, at: plus(b, unit(a, b), AWAY) } : null;
  }

  // the slide of the chosen point whose direction can be turned, with the place of its handle
  get turned() {
    const letter = this.chosen?.point;
    const pair = this.structure?.pairs.find((one) => one.guide && one.code === "P" && !one.is_cylinder && one.links[0] === "frame" && one.points[0] === letter);
    const at = pair && this.at(letter);
    if (!at) return null;
    const angle = this.angle("frame") + pair.guide[2];
    return { pair: pair.name, letter, angle, at: [at[0] + GUIDE * Math.cos(angle), at[1] - GUIDE * Math.sin(angle)] };
  }

  // links under a place of the screen: two where they cross
  linksUnder(at) {
    return (this.structure?.links ?? []).filter(({ name, points }) => {
      const corners = points.map((one) => this.at(one)).filter(Boolean);
      return name !== "frame" && corners.some((one, k) => k && toSegment(at, corners[k - 1], one) <= NEAR_BAR);
    }).map((one) => one.name);
  }

  // lines and circles that a place can be snapped to: about the pivots of a bar, without the letters that are moved
  #curves(letters, pivots) {
    const found = [], links = (this.structure?.links ?? []).filter((one) => one.name !== "frame" && one.points.length > 1);
    const sides = links.flatMap(({ name, points }) => points.slice(1).map((one, k) => ({ name, points: [points[k], one], ends: [this.place(points[k]), this.place(one)] })));
    const known = sides.filter(({ ends: [a, b] }) => a && b && distance(a, b) > 0);
    const others = known.filter((one) => !one.points.some((letter) => letters.includes(letter)));
    for (const [at, letter] of pivots) {
      found.push({ at, along: [1, 0], words: "horizontal", is_own: true }, { at, along: [0, 1], words: "vertical", is_own: true });
      for (const { name, ends, points } of known) {
        if (!points.some((one) => letters.includes(one))) found.push({ at, radius: distance(...ends), words: `as long as ${name}` });
        if (letter && points.includes(letter) && !points.some((one) => letters.includes(one))) {
          const along = unit(...ends);
          found.push({ at, along: [-along[1], along[0]], words: `right angle to ${name}`, is_own: true }, { at, along, words: `in line with ${name}` });
        }
      }
    }
    for (const { name, ends } of others) found.push({ at: ends[0], along: unit(...ends), words: `on the line of ${name}` });
    for (const { guide, links: [on], points } of this.structure?.pairs ?? []) {
      if (guide && on === "frame" && !points.some((one) => letters.includes(one))) found.push({ at: [guide[0], guide[1]], along: [Math.cos(guide[2]), Math.sin(guide[2])], words: "on the guide" });
    }
    for (const letter of this.allLetters.filter((one) => !letters.includes(one))) {
      const at = this.place(letter);
      if (at && !pivots.some(([one]) => distance(one, at) === 0)) found.push({ at, along: [1, 0], words: `level with ${letter}` }, { at, along: [0, 1], words: `above ${letter}` });
    }
    return found;
  }

  // the place that a gesture means: what is near, snapped to, with what it was snapped to
  snapped(at, { letters = [], pivots = [] } = {}) {
    const here = this.plane(at), near = (p) => distance(p, here) * this.view.scale;
    const close = this.#curves(letters, pivots).map((one) => ({ ...one, foot: nearest(one, here) }))
      .filter((one) => near(one.foot) <= NEAR).sort((a, b) => near(a.foot) - near(b.foot) - (a.is_own ? 1 : 0) + (b.is_own ? 1 : 0));
    if (!close.length) return { place: this.rounded(here), to: [] };
    for (const [k, one] of close.entries()) {
      for (const other of close.slice(k + 1)) {
        const place = crossings(one, other).find((p) => near(p) <= NEAR_CROSSING);
        if (place) return { place, to: [one, other] };
      }
    }
    const [one] = close, place = [...one.foot], round = this.rounded(here);
    if (one.along?.[0] === 1) place[0] = round[0];
    if (one.along?.[1] === 1) place[1] = round[1];
    return { place, to: [one] };
  }

  // what lies under a place of the screen: a point, else a link, else a cylinder, else nothing
  under(at, reach = 1, but = []) {
    let best = null, near = NEAR_PIN * reach;
    for (const letter of Object.keys(this.structure?.points ?? {})) {
      const there = but.includes(letter) ? null : this.at(letter);
      // of two at one place the older: the younger is that of its guide
      if (there && distance(at, there) < near) [best, near] = [{ point: letter }, distance(at, there)];
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
    for (const { name, points, is_cylinder: is } of this.structure?.pairs ?? []) {
      const [a, b] = is ? points.map((one) => this.at(one)) : [];
      if (!best && a && b && toSegment(at, a, b) <= NEAR_BAR * reach) best = { pair: name };
    }
    for (const { name, shapes } of best ? [] : this.structure?.pairs ?? []) {
      // the rim of a wheel or a profile is its pair
      const isNear = (shape) => (shape.line
        ? this.#outline(shape).some((one, k, all) => k && toSegment(at, all[k - 1], one) <= near)
        : Math.abs(distance(at, this.#inLink(shape.link)(shape.at)) - shape.radius * this.view.scale) <= near);
      if (shapes?.some(isNear)) best ??= { pair: name };
    }
    return best;
  }

  show(structure) {
    this.structure = structure;
    this.draw();
  }

  draw() {
    for (const one of this.before) one();
    this.#draw();
    for (const one of this.after) one();
  }

  #draw() {
    const layers = this.layers.filter((name) => !KEPT.includes(name)).map((name) => this[name]);
    for (const one of layers) one.begin();
    this.#photograph();
    if (this.structure) this.#mechanism();
    for (const one of layers) one.end();
  }

  #mechanism() {
    const { links, pins, pairs, faults } = this.structure;
    const wrong = new Set(faults.filter((one) => one.kind === "over").flatMap((one) => one.links));
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
        this.links.put("path", { d: path, class: `${classes}${isOver ? " over" : ""}${wrong.has(link.name) ? " bad" : ""}`, "data-link": link.name });
      }
    }
    this.#drives();
    for (const letter of Object.keys(this.structure.points)) {
      const at = this.at(letter);
      if (!at) continue;
      const state = `${this.picked.has(letter) ? " picked" : ""}${this.over?.point === letter ? " over" : ""}${this.chosen?.point === letter ? " chosen" : ""}`;
      this.pins.put("circle", { cx: at[0], cy: at[1], r: pins[letter] ? 5.5 : 4, class: `pin${pins[letter] ? "" : " end"}${state}`, "data-point": letter });
      const side = this.#side(letter, at), x = at[0] + LETTER * Math.cos(side), y = at[1] + LETTER * Math.sin(side) + 5;
      this.letters.put("text", { x, y, "text-anchor": "middle" }, letter);
    }
    this.#locks();
    const { drawn, turned } = this;
    if (drawn) this.letters.put("rect", { x: drawn.at[0] - 6, y: drawn.at[1] - 6, width: 12, height: 12, class: "grip" });
    if (turned) this.letters.put("circle", { cx: turned.at[0], cy: turned.at[1], r: 7, class: "grip" });
  }

  // the direction from a point to its letter: no bar and no ground is drawn there while there is another
  #side(letter, at) {
    const ways = [];
    for (const { name, points } of this.structure.links) {
      if (!points.includes(letter)) continue;
      if (name === "frame") ways.push(Math.PI / 2);
      else for (const one of points) if (one !== letter && this.at(one)) ways.push(Math.atan2(this.at(one)[1] - at[1], this.at(one)[0] - at[0]));
    }
    for (const { guide, points, links: [on], is_cylinder: is } of this.structure.pairs) {
      if (!guide || is || points[0] !== letter) continue;
      const along = -(this.angle(on) + guide[2]);
      ways.push(along, along + Math.PI);
    }
    const room = (k) => Math.min(...ways.map((way) => Math.abs(Math.atan2(Math.sin(way - SIDES[k]), Math.cos(way - SIDES[k])))), Math.PI);
    let side = this.sides.get(letter) ?? 0;
    if (room(side) < HELD) {
      const rooms = SIDES.map((_, k) => room(k)), free = rooms.findIndex((one) => one >= FREE);
      side = free < 0 ? rooms.indexOf(Math.max(...rooms)) : free;
    }
    this.sides.set(letter, side);
    return SIDES[side];
  }

  #photograph() {
    const { photo } = this;
    if (!photo) { this.below.replaceChildren(); return; }
    const [x, y] = this.screen([photo.x, photo.y]), by = photo.scale * this.view.scale;
    let image = this.below.firstChild;
    if (!image) image = svgElement("image", { preserveAspectRatio: "none" }, this.below);
    if (image.getAttribute("href") !== photo.href) image.setAttribute("href", photo.href);
    for (const [key, value] of Object.entries({ x, y, width: photo.wide * by, height: photo.high * by, opacity: photo.opacity })) image.setAttribute(key, value);
  }

  #locks() {
    for (const { what, points } of this.locks) {
      const places = points.map((one) => this.at(one)), [a, b] = places;
      if (places.some((one) => !one)) continue;
      if (what === "point") { this.marks.put("path", { d: `M${a[0] - 9} ${a[1] - 9}h18v18h-18Z`, class: "lock" }); continue; }
      const [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], [u, v] = unit(a, b), [p, q] = [-v * 9, u * 9];
      const tick = (by) => `M${x + by * u - p} ${y + by * v - q}L${x + by * u + p} ${y + by * v + q}`;
      this.marks.put("path", { d: what === "length" ? tick(-3) + tick(3) : `M${x - 9} ${y}a9 9 0 1 0 18 0a9 9 0 1 0 -18 0`, class: "lock" });
    }
  }

  #inPlane(link) {
    const [[u, v], turned] = this.#lying(link), [c, s] = [Math.cos(turned), Math.sin(turned)];
    return ([x, y]) => [u + c * x - s * y, v + s * x + c * y];
  }

  // from the frame of a link to the screen
  #inLink(link) {
    const inPlane = this.#inPlane(link);
    return (at) => this.screen(inPlane(at));
  }

  #outline({ link, line, is_closed: isClosed }) {
    const at = this.#inLink(link), places = line[0].map((x, k) => at([x, line[1][k]]));
    return isClosed ? [...places, places[0]] : places;
  }

  // a wheel or a profile, in the frame of its link
  #shape(shape) {
    const style = `shape${colour(this.link(shape.link)?.colour)}`;
    if (shape.line) {
      const path = this.#outline(shape).map((one) => one.map((n) => n.toFixed(2)).join(" ")).join("L");
      this.shapes.put("path", { d: `M${path}${shape.is_closed ? "Z" : ""}`, class: style });
      return;
    }
    const [x, y] = this.#inLink(shape.link)(shape.at), r = shape.radius * this.view.scale, turned = this.angle(shape.link);
    this.shapes.put("circle", { cx: x, cy: y, r, class: `${style}${shape.teeth ? " gear" : ""}` });
    // a spoke shows how it turns
    this.shapes.put("path", { d: `M${x} ${y}L${x + r * Math.cos(turned)} ${y - r * Math.sin(turned)}`, class: `${style} spoke` });
  }

  #cylinder([a, b]) {
    const [u, v] = unit(b, a), long = distance(a, b), barrel = Math.min(0.62 * long, long - 14);
    this.links.put("path", { d: `M${b[0]} ${b[1]}L${b[0] + barrel * u} ${b[1] + barrel * v}`, class: "barrel" });
    this.links.put("path", { d: `M${b[0]} ${b[1]}L${b[0] + barrel * u} ${b[1] + barrel * v}`, class: "barrel inner" });
    this.links.put("path", { d: `M${b[0] + 0.5 * barrel * u} ${b[1] + 0.5 * barrel * v}L${a[0]} ${a[1]}`, class: "rod" });
  }

  // whether a point's path is shown: of those that only one moving link has, unless it was chosen otherwise
  isTraced(letter) { return (!this.frame.includes(letter) && !this.structure.pins[letter]) !== this.toggled.has(letter); }

  // the paths of points, also of the one that is chosen
  #traces() {
    if (!this.motion?.poses) return;
    const { frame } = this;
    for (const letter of Object.keys(this.motion.points)) {
      if (!this.isTraced(letter) && (this.chosen?.point !== letter || frame.includes(letter))) continue;
      const [xs, ys] = this.motion.points[letter];
      let path = "", pen = "M";
      xs.forEach((x, k) => {
        if (x === null) { pen = "M"; return; }
        const at = this.screen([x, ys[k]]);
        path += `${pen}${at[0].toFixed(1)} ${at[1].toFixed(1)}`;
        pen = "L";
      });
      if (path) this.traces.put("path", { d: path, class: "trace" });
    }
  }

  #ground([x, y]) {
    const lines = [-12, -6, 0, 6, 12].map((k) => `M${x + k} ${y + 16}l-5 7`).join("");
    this.marks.put("path", { d: `M${x} ${y}l-11 16h22Z M${x - 15} ${y + 16}h30${lines}`, class: "ground" });
  }

  #pair(pair) {
    const places = pair.points.map((one) => this.at(one)).filter(Boolean);
    if (pair.shapes?.length) { for (const one of pair.shapes) this.#shape(one); return; }
    if (pair.is_cylinder) { if (places.length > 1) this.#cylinder(places); return; }
    if (pair.guide && places.length > 1) {
      const [on] = pair.links, turned = -(this.angle(on) + pair.guide[2]), degrees = (turned * 180) / Math.PI;
      const [x, y] = places[0], [ux, uy] = [Math.cos(turned), Math.sin(turned)];
      const far = Math.max(60, distance(places[0], places[1]) + 40);
      if (on === "frame") this.guides.put("path", { d: `M${x - far * ux} ${y - far * uy}L${x + far * ux} ${y + far * uy}`, class: "guide" });
      if (pair.code === "P") this.marks.put("rect", { x: -15, y: -9, width: 30, height: 18, rx: 2, class: "block", transform: `translate(${x} ${y}) rotate(${degrees})` });
    } else if (places.length > 1) {
      this.guides.put("path", { d: `M${places.map((one) => one.join(" ")).join("L")}`, class: "tie" });
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
      this.marks.put("path", { d: arrow, class: "turns" });
    }
    const at = this.handle && this.at(this.handle);
    if (at) this.marks.put("circle", { cx: at[0], cy: at[1], r: 12, class: "handle" });
  }

  // what a gesture shows above the drawing: the bar to be, the ring around what would be joined, what it snaps to
  sketch({ from, to, ring, words, snaps = [], box, guide } = {}) {
    this.above.replaceChildren();
    const far = Math.hypot(...this.size);
    for (const one of snaps) {
      const [x, y] = this.screen(one.at);
      if (one.along) svgElement("path", { d: `M${x - far * one.along[0]} ${y + far * one.along[1]}L${x + far * one.along[0]} ${y - far * one.along[1]}`, class: "snap" }, this.above);
      else svgElement("circle", { cx: x, cy: y, r: one.radius * this.view.scale, class: "snap" }, this.above);
    }
    if (guide) svgElement("path", { d: `M${guide.at[0] - far * Math.cos(guide.angle)} ${guide.at[1] + far * Math.sin(guide.angle)}L${guide.at[0] + far * Math.cos(guide.angle)} ${guide.at[1] - far * Math.sin(guide.angle)}`, class: "snap" }, this.above);
    if (box) svgElement("rect", { x: Math.min(box[0][0], box[1][0]), y: Math.min(box[0][1], box[1][1]), width: Math.abs(box[0][0] - box[1][0]), height: Math.abs(box[0][1] - box[1][1]), class: "box" }, this.above);
    if (from && to) svgElement("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], class: "rubber" }, this.above);
    if (ring) svgElement("circle", { cx: ring[0], cy: ring[1], r: 15, class: "ring" }, this.above);
    if (words && to) svgElement("text", { x: to[0] + 16, y: to[1] + 24 }, this.above).textContent = words;
  }
}
