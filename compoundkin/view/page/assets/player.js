// The player: the sketch moves with its links, pose by pose as they were solved; nothing here computes a mechanism.
// On a live page its `design` does, with other dimensions, and the player takes what was computed in place of that.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const SVG = "http://www.w3.org/2000/svg";
  const DEGREE = 180 / Math.PI;
  const FAR = 1e5; // picture units: beyond, a place is a direction
  const DOT = 3.2;
  // pixels for a picture unit: names are no smaller and no larger than at these (the smallest are 11 units high), but
  // at most so many times as large as they are drawn
  const LEGIBLE = 12.4 / 11, LARGE = 1.5, LARGEST = 6;
  const OF_LETTERS = 11 / 14; // the size of numbers to that of letters
  const ROOM = 10; // for what names have grown, around the picture
  const WIDE = 4.4, TALL = 8, RIM = 9.5; // half a letter's width and height, and the circle around a number
  const TOGETHER = 3; // centres nearer to each other are named together
  const ROUNDING = 3e-7;
  const SCALE = 18; // the height of the line that tells a scale of vectors
  const KEY = 22; // the length of an arrow that tells a colour
  const VECTORS = [["velocity", 1, "velocities"], ["acceleration", 2, "accelerations"]];
  const HEAD = 10, HALF = 3.6; // an arrow's head, as in every other picture

  // --- numbers as packing.py writes them: one for all poses, or one for each ----------------------------------------
  const unpacked = (text, count) => {
    if (text === null) return new Float64Array(count).fill(NaN);
    if (typeof text === "number") return new Float64Array(count).fill(text);
    if (text[0] === "r") {
      const [first, step] = text.slice(2).split(",").map(Number);
      return Float64Array.from({ length: count }, (_, k) => first + step * k);
    }
    const bytes = Uint8Array.from(atob(text.slice(2)), (c) => c.charCodeAt(0));
    return text[0] === "d" ? new Float64Array(bytes.buffer) : Float64Array.from(new Float32Array(bytes.buffer));
  };
  // six digits, as in the report; no minus sign without a number
  const written = (value) => {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    const text = size && (size >= 1e6 || size < 1e-4) ? value.toExponential(5) : String(Number(value.toPrecision(6)));
    return text.replace("-", "−");
  };
  const make = (name, attributes, parent) => {
    const element = document.createElementNS(SVG, name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (parent) parent.append(element);
    return element;
  };
  const raised = (unit) => unit.replace("^2", "²").replace("^3", "³").replace(/^deg$/, "°").replace(/^deg\//, "°/");
  const withUnit = (value, unit) => {
    if (!Number.isFinite(value)) return written(value);
    return unit === "deg" ? `${written(value)}°` : `${written(value)} ${raised(unit)}`.trim();
  };

  // rates are packed with seven digits: a sum that is smaller beside its terms is rounding
  const summed = (...terms) => {
    const sum = terms.reduce((all, term) => all + term, 0);
    return Math.abs(sum) < ROUNDING * Math.max(...terms.map(Math.abs)) ? 0 : sum;
  };

  const filled = (values, from) => (from ? values.set(from) : values.fill(NaN));

  // as outputs are told: angles in degrees, zero what is rounding
  const cleaned = (values, { unit, floor }) => {
    const by = unit === "deg" ? DEGREE : 1;
    for (let k = 0; k < values.length; k++) values[k] = Math.abs(values[k]) <= floor ? 0 : values[k] * by + 0;
  };

  // a point of a link, in its own frame (px, py), at a pose
  const pointAt = (link, px, py, k) => {
    const c = Math.cos(link.angle[k]), s = Math.sin(link.angle[k]);
    return [link.x[k] + c * px - s * py, link.y[k] + s * px + c * py];
  };

  class Player {
    constructor(root, data) {
      this.root = root;
      this.data = data;
      this.poses = data.poses;
      this.pose = -1;
      this.listeners = [];
      const open = (text) => unpacked(text, data.poses);
      this.assembled = open(data.assembled);
      this.along = { ...data.along, values: open(data.along.values) };
      this.indices = open(data.indices);
      // what its program finds by itself a live page does not hold
      this.path = data.live && !data.live.why ? new page.Path(data) : null;
      const found = this.path && this.path.solved(this.path.own);
      this.links = data.links.map((link, k) => (link.x === undefined ? { ...link, ...found.links[k] } : {
        ...link, x: open(link.x), y: open(link.y), angle: open(link.angle),
        v: link.v && link.v.map(open), a: link.a && link.a.map(open),
      }));
      this.upright = this.links.map(({ angle }) => angle[data.start]);
      const quantity = (one) => ({
        ...one, parts: Object.fromEntries(Object.entries(one.parts).map(([name, text]) => [name, open(text)])),
      });
      this.drivers = data.drivers.map(quantity);
      this.outputs = data.outputs.map(quantity);
      const known = new Set(found ? data.live.program.outputs.filter(({ own }) => own).map(({ name }) => name) : []);
      for (const output of this.outputs.filter(({ name }) => known.has(name))) {
        for (const part in output.parts) {
          output.parts[part].set(found.outputs[output.name][part]);
          cleaned(output.parts[part], output);
        }
      }
      this.centres = data.centres.map((centre) => ({ ...centre, at: centre.at && centre.at.map(open) }));
      if (data.forces) {
        this.forces = data.forces.arrows.map((one) => ({ ...one, force: one.force.map(open), at: one.at && one.at.map(open) }));
      }
      this.points = Object.fromEntries(data.points.map((point) => [point.name, point]));
      this.shown = new Set(["names"]);
      this.letters = 1;
      this.whole = 1; // the same where the picture is not enlarged
      this.room = this.base = { left: 0, top: 0, width: data.window.width, height: data.window.height };
      this.find();
      this.listen();
      this.design = null; // of a live page: design.js
      this.show(data.start);
      new ResizeObserver(() => this.fit()).observe(this.svg);
    }

    find() {
      const one = (selector) => this.root.querySelector(selector);
      this.svg = one("svg.sketch");
      this.parts = [...this.svg.querySelectorAll(".parts > g")];
      this.placed = [];
      this.names = this.parts.map((part) => (part.classList.contains("name") ? this.box(part) : null));
      this.layers = Object.fromEntries(["traces", "rays", "velocities", "accelerations", "forces", "dots"].map((k) => [k, one(`svg .${k}`)]));
      Object.assign(this, { slider: one(".slider"), play: one(".play"), where: one(".where"), said: one(".said"), reason: one(".reason") });
      this.reading = one(".reading tbody");
      this.rows = this.outputs.map((output) => {
        const row = this.reading.insertRow();
        const head = document.createElement("th");
        head.scope = "row";
        // long names may be broken after their dots and underscores
        head.textContent = output.name.replace(/([._])/g, "$1\u200b");
        row.append(head);
        const cell = row.insertCell();
        return Object.entries(output.parts).map(([name, values]) => {
          const place = document.createElement("span");
          cell.append(place, " ");
          return { place, values, name, unit: output.unit };
        });
      });
    }

    // --- other dimensions: what was computed, or null for what the page came with ----------------------------------------
    // the arrays stay the same ones, so that whoever holds them sees the new numbers
    take(solved) {
      this.given ??= this.copied();
      const { assembled, links, outputs } = solved || this.given;
      this.assembled.set(assembled);
      this.links.forEach((link, k) => {
        for (const key of ["x", "y", "angle"]) link[key].set(links[k][key]);
        for (const key of ["v", "a"]) if (link[key]) link[key].forEach((values, part) => filled(values, links[k][key] && links[k][key][part]));
      });
      for (const output of this.outputs) {
        for (const part in output.parts) {
          filled(output.parts[part], outputs && outputs[output.name] && outputs[output.name][part]);
          if (solved) cleaned(output.parts[part], output);
        }
      }
      this.lettered();
      this.showAgain();
      if ([...this.shown].some((name) => name.startsWith("path "))) this.trace();
    }
    copied() {
      const links = this.links.map(({ x, y, angle, v, a }) => ({
        x: x.slice(), y: y.slice(), angle: angle.slice(), v: v && v.map((one) => one.slice()), a: a && a.map((one) => one.slice()),
      }));
      const parts = (output) => Object.fromEntries(Object.entries(output.parts).map(([name, values]) => [name, values.slice()]));
      return { assembled: this.assembled.slice(), links, outputs: Object.fromEntries(this.outputs.map((one) => [one.name, parts(one)])) };
    }
    // points, and the pins and letters drawn there, are where the dimensions have them on their links
    lettered() {
      const { design } = this, at = (link, letter) => {
        const base = `${this.links[link].name}.${letter}`;
        return [design.value(`${base}.x`), design.value(`${base}.y`)];
      };
      for (const letter in this.points) {
        const point = this.points[letter], [x, y] = at(point.link, letter);
        if (x !== undefined && y !== undefined) Object.assign(point, { x, y });
      }
      this.parts.forEach((part, index) => {
        const own = this.data.parts[index], { letter } = part.dataset;
        const [x, y] = letter ? at(own[0], letter) : [];
        if (x !== undefined && y !== undefined) [own[1], own[2]] = [x, y];
      });
    }

    listen() {
      const on = (selector, kind, act) => {
        const element = this.root.querySelector(selector);
        if (element) element.addEventListener(kind, act);
      };
      this.slider.addEventListener("input", () => { this.stop(); this.show(Number(this.slider.value)); });
      on(".back", "click", () => { this.stop(); this.step(-1); });
      on(".forth", "click", () => { this.stop(); this.step(1); });
      this.play.addEventListener("click", () => (this.playing ? this.stop() : this.start()));
      if (this.poses < 2) for (const control of this.root.querySelectorAll(".transport :is(button, input, select)")) control.disabled = true;
      const boxes = [...this.root.querySelectorAll("[data-show]")];
      const take = (box) => this.shown[box.checked ? "add" : "delete"](box.dataset.show);
      for (const box of boxes) box.addEventListener("change", () => { take(box); this.switched(); });
      // browsers remember where the slider was and what was switched on when one comes back to a page
      addEventListener("pageshow", () => {
        boxes.forEach(take);
        this.switched();
        this.show(Number(this.slider.value));
      });
    }

    // on a small picture names are drawn larger, so that they stay legible; where it is enlarged they do not grow with it
    fit() {
      const grown = ({ width, height }) => {
        const pixels = Math.min(this.svg.clientWidth / width, this.svg.clientHeight / height);
        return pixels > 0 ? Math.min(LARGEST, Math.max(Math.min(1, LARGE / pixels), LEGIBLE / pixels)) : 1;
      };
      const letters = grown(this.svg.viewBox.baseVal), whole = grown(this.base);
      if (Math.abs(letters - this.letters) < 0.02 && Math.abs(whole - this.whole) < 0.02) return;
      Object.assign(this, { letters, whole });
      this.makeRoom();
      if (this.assembled[this.pose] === 1) this.move(this.pose);
      this.overlay();
    }

    // --- where things are, in the user's length unit ----------------------------------------------------------------
    place(letter, k = this.pose) {
      const point = this.points[letter];
      return this.at(point.link, point.x, point.y, k);
    }
    at(index, px, py, k) {
      return pointAt(this.links[index], px, py, k);
    }
    // the velocity (order 1) or acceleration (order 2) of a point: of the link's origin, and of its turning
    rate(letter, order, k = this.pose) {
      const point = this.points[letter], link = this.links[point.link];
      if (!link.v || (order === 2 && !link.a)) return [NaN, NaN];
      const [x, y] = this.place(letter, k), rx = x - link.x[k], ry = y - link.y[k];
      const turning = link.v[2][k];
      if (order === 1) return [summed(link.v[0][k], -turning * ry), summed(link.v[1][k], turning * rx)];
      const alpha = link.a[2][k];
      return [summed(link.a[0][k], -alpha * ry, -(turning ** 2) * rx), summed(link.a[1][k], alpha * rx, -(turning ** 2) * ry)];
    }
    paper([x, y]) {
      const window = this.data.window;
      return [(x - window.x) * window.scale, (window.y - y) * window.scale];
    }
    // where the sketch really shows a point, read back from the picture
    drawn(letter) {
      const part = this.parts.find((one) => one.dataset.letter === letter), window = this.data.window;
      const [x, y] = part.getAttribute("transform").match(/-?[\d.]+(e[+-]?\d+)?/g).map(Number);
      return [x / window.scale + window.x, window.y - y / window.scale];
    }

    // --- one pose ---------------------------------------------------------------------------------------------------
    show(k) {
      if (k === this.pose) return;
      this.pose = k;
      this.showAgain();
      document.dispatchEvent(new CustomEvent("compoundkin:pose", { detail: { pose: this.indices[k], player: this } }));
    }
    showAgain() {
      const k = this.pose;
      const known = this.assembled[k] === 1;
      this.svg.classList.toggle("unassembled", !known);
      this.slider.value = k;
      const where = this.told(k);
      this.where.textContent = where;
      this.slider.setAttribute("aria-valuetext", known ? where : `${where}, cannot be assembled`);
      // said once, not again at every pose of a gap
      const said = known ? "" : "The mechanism cannot be assembled here.";
      if (this.said.textContent !== said) this.said.textContent = said;
      const why = known || !this.design ? "" : this.design.why(k);
      if (this.reason && this.reason.textContent !== why) this.reason.textContent = why;
      if (known) this.move(k);
      this.overlay();
      for (const row of this.rows) {
        for (const { place, values, name, unit } of row) place.textContent = `${name ? `${name} ` : ""}${withUnit(values[k], unit)}`;
      }
      for (const heard of this.listeners) heard(k);
    }
    step(by) {
      const last = this.poses - 1;
      const to = this.pose + by;
      this.show(to < 0 ? last : to > last ? 0 : to);
    }
    told(k) {
      const words = this.drivers.map((driver) => `${driver.name} ${withUnit(driver.parts[""][k], driver.unit)}`);
      if (this.along.name === "time") words.unshift(`${written(this.along.values[k])} s`);
      return words.length ? words.join(", ") : `pose ${k + 1} of ${this.poses}`;
    }
    move(k) {
      this.parts.forEach((part, index) => {
        const name = this.letters !== 1 && this.names[index];
        const placed = this.placement(this.links, this.data.parts[index], k, name);
        // the frame's parts stay where they are
        if (placed !== this.placed[index]) part.setAttribute("transform", placed);
        this.placed[index] = placed;
      });
    }

    // where a part is at a pose of some links; shapes that turn are drawn as at the first pose of the page
    placement(links, [link, px, py, turns], k, name = null) {
      const at = this.paper(pointAt(links[link], px, py, k)), [x, y] = name ? this.within(at, name) : at;
      // y points downward on paper: what turns counterclockwise has a negative angle there
      const turned = turns ? ` rotate(${-(links[link].angle[k] - this.upright[link]) * DEGREE})` : "";
      return `translate(${x} ${y})${turned}${name ? ` scale(${this.grown(name)})` : ""}`;
    }

    // the box of a name as seen from the point it belongs to: its middle, half its width and height
    box(part) {
      const text = part.querySelector("text");
      const [x, y] = ["x", "y"].map((name) => Number(text.getAttribute(name)));
      const round = part.querySelector("circle"), small = round ? 1 : OF_LETTERS;
      return { x, y, wide: round ? RIM : Math.max(WIDE * text.textContent.length, text.getComputedTextLength() / 2), tall: round ? RIM : TALL, small };
    }
    // letters are larger than numbers, and have to grow less
    grown(name) {
      return this.letters > 1 ? Math.max(1, this.letters * name.small) : this.letters;
    }
    // where a name that has grown is put, so that it stays in the picture
    within([x, y], name) {
      const { left, top, width, height } = this.room, by = this.grown(name);
      const held = (at, off, half, from, size) => Math.max(from + by * half, Math.min(from + size - by * half, at + by * off)) - by * off;
      return [held(x, name.x, name.wide, left, width), held(y, name.y, name.tall, top, height)];
    }

    // --- what is switched on and off --------------------------------------------------------------------------------
    switched() {
      this.svg.classList.toggle("nameless", !this.shown.has("names"));
      this.makeRoom();
      this.trace();
      this.overlay();
    }
    get isChanged() {
      return Boolean(this.design && this.design.isChanged);
    }
    // forces are those of the dimensions that the page came with
    get showsForces() {
      return Boolean(this.forces && this.shown.has("forces") && !this.isChanged);
    }
    // vectors get the room that their tips take at any pose, and their scales a place below
    makeRoom() {
      const { width, height } = this.data.window;
      // at other dimensions points may go beyond the picture as it was made
      const extent = this.extent || [0, 0, width, height];
      let [left, top, right, bottom] = [Math.min(0, extent[0]), Math.min(0, extent[1]), Math.max(width, extent[2]), Math.max(height, extent[3])];
      const kinds = VECTORS.filter(([kind]) => this.shown.has(kind) && this.data.vectors[kind]);
      for (const [kind, order] of kinds) {
        for (const letter in this.points) {
          for (let k = 0; k < this.poses; k++) {
            const [x, y] = this.paper(this.place(letter, k));
            const [dx, dy] = this.rate(letter, order, k).map((c) => c * this.data.vectors[kind].scale);
            if (!Number.isFinite(x + y + dx + dy)) continue;
            left = Math.min(left, x + dx - HALF);
            right = Math.max(right, x + dx + HALF);
            top = Math.min(top, y - dy - HALF);
            bottom = Math.max(bottom, y - dy + HALF);
          }
        }
      }
      const told = kinds.length + (this.showsForces ? 1 + Object.keys(this.data.forces.kinds).length : 0);
      if (this.showsForces) {
        for (const one of this.forces) {
          for (let k = 0; k < this.poses; k++) {
            const [x, y] = this.paper(this.acts(one, k)), [dx, dy] = one.force.map((c) => c[k] * this.data.forces.scale);
            if (!Number.isFinite(x + y + dx + dy)) continue;
            left = Math.min(left, x + dx - HALF);
            right = Math.max(right, x + dx + HALF);
            top = Math.min(top, y - dy - HALF);
            bottom = Math.max(bottom, y - dy + HALF);
          }
        }
      }
      this.base = { width: right - left, height: bottom - top };
      const around = ROOM * Math.max(0, this.whole - 1);
      [left, top, right] = [left - around, top - around, right + around];
      bottom += around + told * SCALE * this.whole;
      this.room = { left, top, width: right - left, height: bottom - top };
      this.seeRoom();
    }
    // what of its room is seen: all of it, unless view_box.js enlarges it
    seeRoom() {
      const { left, top, width, height } = this.room;
      this.svg.setAttribute("viewBox", `${left} ${top} ${width} ${height}`);
    }
    overlay() {
      const known = this.assembled[this.pose] === 1;
      for (const [kind, order, layer] of VECTORS) {
        this.layers[layer].replaceChildren();
        if (known && this.shown.has(kind)) this.vectors(kind, order, this.layers[layer]);
      }
      this.layers.forces.replaceChildren();
      if (known && this.showsForces) this.acting(this.layers.forces);
      this.layers.dots.replaceChildren();
      this.layers.rays.replaceChildren();
      if (known && this.shown.has("centres")) this.centred();
    }
    vectors(kind, order, layer) {
      const scale = this.data.vectors[kind];
      for (const letter in this.points) {
        const [vx, vy] = this.rate(letter, order).map((c) => c * scale.scale);
        if (Math.hypot(vx, vy) >= scale.shortest) this.arrow(this.paper(this.place(letter)), [vx, -vy], kind, layer);
      }
      const both = kind === "acceleration" && this.shown.has("velocity");
      const { left, top, height } = this.room, x = left + 12, y = top + height - (both ? 1.5 : 0.5) * SCALE * this.letters;
      this.arrow([x, y], [scale.length, 0], kind, layer);
      this.text(`${kind}, ${scale.text}`, x + 8 + scale.length, y, "ck-note", "start", layer);
    }
    // where a force acts: at a point of its link, or where it was told for every pose
    acts(one, k = this.pose) {
      return one.at ? one.at.map((values) => values[k]) : this.at(one.link, one.x, one.y, k);
    }
    acting(layer) {
      const { scale, shortest, length, text, kinds, unit } = this.data.forces;
      for (const one of this.forces) {
        const [fx, fy] = one.force.map((c) => c[this.pose]);
        if (!(Math.hypot(fx, fy) * scale >= shortest)) continue;
        const group = make("g", {}, layer);
        make("title", {}, group).textContent = `${one.told}: ${withUnit(Math.hypot(fx, fy), unit)}`;
        this.arrow(this.paper(this.acts(one)), [fx * scale, -fy * scale], one.kind, group);
      }
      const before = VECTORS.filter(([kind]) => this.shown.has(kind) && this.data.vectors[kind]).length;
      const rows = [["drive", text], ...Object.entries(kinds)];
      rows.forEach(([kind, words], row) => {
        const { left, top, height } = this.room, x = left + 12, y = top + height - (before + rows.length - row - 0.5) * SCALE * this.letters;
        const long = kind === "drive" ? length : KEY;
        this.arrow([x, y], [long, 0], kind, layer);
        this.text(words, x + 8 + long, y, "ck-note", "start", layer);
      });
    }
    text(words, x, y, style, anchor, layer) {
      const grown = this.letters !== 1 ? ` scale(${this.letters})` : "";
      make("text", { class: style, transform: `translate(${x} ${y})${grown}`, dy: "0.35em", "text-anchor": anchor }, layer).textContent = words;
    }
    arrow([x, y], [dx, dy], kind, layer) {
      const length = Math.hypot(dx, dy), ex = dx / length, ey = dy / length, head = Math.min(HEAD, 0.6 * length);
      const tip = [x + dx, y + dy], back = [tip[0] - ex * head, tip[1] - ey * head], half = (HALF * head) / HEAD;
      make("path", { class: `ck-${kind}`, d: `M${x} ${y}L${tip[0] - ex * head * 0.8} ${tip[1] - ey * head * 0.8}` }, layer);
      const sides = `L${back[0] - ey * half} ${back[1] + ex * half}L${back[0] + ey * half} ${back[1] - ex * half}Z`;
      make("path", { class: `ck-${kind}-head`, d: `M${tip[0]} ${tip[1]}${sides}` }, layer);
    }
    centred() {
      const { width, height } = this.data.window;
      const places = this.centres.map((centre) => {
        const [x, y, w] = this.isChanged || !centre.at ? this.pole(centre) : centre.at.map((values) => values[this.pose]);
        if (!Number.isFinite(x + y + w)) return null;
        const [px, py] = this.paper([x / w, y / w]);
        const near = Math.abs(px) < FAR && Math.abs(py) < FAR;
        return near ? { x: px, y: py } : { far: [x / Math.hypot(x, y), -y / Math.hypot(x, y)] };
      });
      const inside = (p) => p && !p.far && p.x >= 0 && p.y >= 0 && p.x <= width && p.y <= height;
      for (const [own, ...through] of this.data.lines) if (inside(places[own])) this.ray([own, ...through].map((k) => places[k]));
      const named = [];
      this.centres.forEach(({ name }, k) => {
        const p = places[k];
        if (!inside(p)) return;
        const same = named.find((other) => Math.hypot(other.x - p.x, other.y - p.y) < TOGETHER);
        if (same) same.names.push(name);
        else named.push({ ...p, names: [name] });
      });
      const taken = this.shown.has("names") ? this.taken() : [];
      for (const { x, y, names } of named) {
        make("circle", { class: "ck-centre", cx: x, cy: y, r: DOT }, this.layers.dots);
        const text = names.join(" ");
        const at = this.beside(x, y, 3.4 * text.length * this.letters, taken);
        taken.push(at);
        for (const style of ["ck-halo ck-centre-name", "ck-centre-name"]) {
          this.text(text, at.x, at.y, style, "middle", this.layers.dots);
        }
      }
      const gone = this.centres.filter((_, k) => places[k] && places[k].far).map(({ name }) => name);
      if (gone.length) this.text(`at infinity: ${gone.join(", ")}`, 12, 12, "ck-note", "start", this.layers.dots);
    }
    // the centre of a changed mechanism, one that does not depend on how quick the drivers are
    pole({ links, at }) {
      if (at && !at.some((values) => values.some(Number.isFinite))) return [NaN, NaN, NaN];
      const [i, j] = links.map((name) => this.data.links.findIndex((link) => link.name === name));
      const { width, scale } = this.data.window;
      return page.pole(this.links, i, j, this.pose, width / scale);
    }
    // where the letters and numbers are: boxes by their middle and half their size
    taken() {
      return this.parts.flatMap((part, index) => {
        const name = this.names[index];
        if (!name) return [];
        const [x, y] = part.getAttribute("transform").match(/-?[\d.]+(e[+-]?\d+)?/g).map(Number);
        return { x: x + name.x * this.letters, y: y + name.y * this.letters, half: name.wide * this.letters };
      });
    }
    // a place for a name of that half width beside a point: the first that covers none, or the one that covers fewest
    beside(x, y, half, taken) {
      const { width, height } = this.data.window;
      let best = null;
      for (const far of [0, 8, 18]) {
        for (const [ex, ey] of [[1, 1], [1, -1], [-1, 1], [-1, -1], [0, 1], [0, -1]]) {
          const at = { x: x + ex * (half + 6 + far), y: y + ey * (5 + 6 * this.letters + far), half };
          const out = at.x < half || at.x > width - half || at.y < 6 || at.y > height - 6;
          const covers = taken.filter((one) => Math.abs(one.x - at.x) < one.half + half && Math.abs(one.y - at.y) < 13 * this.letters).length;
          at.cost = covers + 10 * out;
          if (!best || at.cost < best.cost) best = at;
          if (!best.cost) return best;
        }
      }
      return best;
    }
    // a line through centres: as long as they reach, or across the picture where one is at infinity
    ray(places) {
      const near = places.filter((p) => p && !p.far), far = places.find((p) => p && p.far);
      if (!near.length || (near.length < 2 && !far)) return;
      let [a, b] = [near[0], near[0]];
      if (far) {
        const reach = 2 * Math.hypot(this.data.window.width, this.data.window.height);
        a = { x: a.x - far.far[0] * reach, y: a.y - far.far[1] * reach };
        b = { x: b.x + far.far[0] * reach, y: b.y + far.far[1] * reach };
      } else {
        const farthest = (from) => near.reduce((best, p) => (Math.hypot(p.x - from.x, p.y - from.y) > Math.hypot(best.x - from.x, best.y - from.y) ? p : best), from);
        a = farthest(near[0]);
        b = farthest(a);
      }
      make("path", { class: "ck-ray", d: `M${a.x} ${a.y}L${b.x} ${b.y}` }, this.layers.rays);
    }
    trace() {
      this.layers.traces.replaceChildren();
      for (const letter in this.points) {
        if (!this.shown.has(`path ${letter}`)) continue;
        let d = "", on = false;
        for (let k = 0; k < this.poses; k++) {
          const known = this.assembled[k] === 1;
          if (known) d += `${on ? "L" : "M"}${this.paper(this.place(letter, k)).map((c) => c.toFixed(2)).join(" ")}`;
          on = known;
        }
        make("path", { class: "ck-path", d }, this.layers.traces);
      }
    }

    // --- playing ----------------------------------------------------------------------------------------------------
    start() {
      this.playing = true;
      this.pressed();
      const last = this.poses - 1, period = this.data.seconds * 1000;
      // how far the motion is, in poses; one that does not close goes there and back
      let at = this.pose, way = 1, before = null;
      const tick = (now) => {
        if (!this.playing) return;
        if (before !== null) at += (way * Math.min(now - before, 100) * this.speed * last) / period;
        before = now;
        if (this.data.closes) at = ((at % last) + last) % last;
        else if (at > last || at < 0) { way = -way; at = Math.min(Math.max(at, 0), last); }
        this.show(Math.round(at));
        this.frame = requestAnimationFrame(tick);
      };
      this.frame = requestAnimationFrame(tick);
    }
    stop() {
      if (!this.playing) return;
      this.playing = false;
      cancelAnimationFrame(this.frame);
      this.pressed();
    }
    pressed() {
      this.play.setAttribute("aria-pressed", String(this.playing));
      this.play.firstElementChild.textContent = this.playing ? "Pause" : "Play";
    }
    get speed() {
      const choice = this.root.querySelector(".speed");
      return choice ? Number(choice.value) : 1;
    }
  }

  Object.assign(page, { Player, written, withUnit, raised, unpacked, drawn: make, players: [] });
  for (const root of document.querySelectorAll(".player")) {
    const data = JSON.parse(document.getElementById("ck-motion").textContent);
    page.players.push(new Player(root, data));
  }
})();
