// The player: the sketch moves with its links, pose by pose as they were solved; nothing here computes a mechanism.
// On a live page its `design` does, with other dimensions, and the player takes what was computed in place of that.
(() => {
  "use strict";
  const page = window.compoundkin;
  const DEGREE = 180 / Math.PI;
  const ROOM = 10; // for what names have grown, around the picture
  const ROUNDING = 3e-7;

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
      // all that listens or waits for it ends with it
      this.ended = new AbortController();
      const open = (text) => page.unpacked(text, data.poses);
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
      this.points = Object.fromEntries(data.points.map((point) => [point.name, point]));
      this.room = this.base = { left: 0, top: 0, width: data.window.width, height: data.window.height };
      this.find();
      this.reading = new page.Reading(this);
      this.letters = new page.Letters(this);
      this.overlays = new page.Overlays(this);
      this.transport = new page.Transport(this);
      this.listen();
      this.design = null; // of a live page: design.js
      this.show(data.start);
      this.watch(new ResizeObserver(() => this.fit()), this.svg);
    }
    get signal() { return this.ended.signal; }
    // what an observer sees of some elements, as long as the player is mounted
    watch(observer, ...elements) {
      for (const one of elements) observer.observe(one);
      this.atEnd(() => observer.disconnect());
    }
    atEnd(run) {
      this.signal.addEventListener("abort", run, { once: true });
    }
    // its markup stays as it is shown, whose it is takes it away; what was added to it goes
    unmount() {
      this.transport.stop();
      this.ended.abort();
      page.players.splice(page.players.indexOf(this), 1);
    }

    find() {
      const one = (selector) => this.root.querySelector(selector);
      this.svg = one("svg.sketch");
      this.parts = [...this.svg.querySelectorAll(".parts > g")];
      this.placed = [];
      Object.assign(this, { said: one(".said"), reason: one(".reason") });
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
      this.overlays.trace();
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

    // what is switched on and off
    listen() {
      const boxes = [...this.root.querySelectorAll("[data-show]")], { shown } = this.overlays;
      const take = (box) => shown[box.checked ? "add" : "delete"](box.dataset.show);
      const { signal } = this;
      for (const box of boxes) box.addEventListener("change", () => { take(box); this.switched(); }, { signal });
      // browsers remember where the slider was and what was switched on when one comes back to a page
      addEventListener("pageshow", () => {
        boxes.forEach(take);
        this.switched();
        this.show(this.transport.asked);
      }, { signal });
    }
    switched() {
      this.svg.classList.toggle("nameless", !this.overlays.shown.has("names"));
      this.makeRoom();
      this.overlays.trace();
      this.overlays.draw();
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
      this.transport.tell(k, this.told(k), known);
      // said once, not again at every pose of a gap
      const said = known ? "" : "The mechanism cannot be assembled here.";
      if (this.said.textContent !== said) this.said.textContent = said;
      const why = known || !this.design ? "" : this.design.why(k);
      if (this.reason && this.reason.textContent !== why) this.reason.textContent = why;
      if (known) this.whole(k);
      else if (this.design) this.part(k);
      this.overlays.draw();
      this.reading.show(k);
      for (const heard of this.listeners) heard(k);
    }
    told(k) {
      const words = this.drivers.map((driver) => `${driver.name} ${page.withUnit(driver.parts[""][k], driver.unit)}`);
      if (this.along.name === "time") words.unshift(`${page.written(this.along.values[k])} s`);
      return words.length ? words.join(", ") : `pose ${k + 1} of ${this.poses}`;
    }
    whole(k) {
      if (this.missed) {
        this.missed.remove();
        this.missed = null;
        this.svg.classList.remove("partly");
        for (const part of this.parts) part.classList.remove("missing");
      }
      this.move(k);
    }
    // of a pose that is not assembled what is known, and the circles that miss each other; what is not known is not drawn
    part(k) {
      const { known, circles, place } = this.design.partial(k), links = known.map((one) => one || { x: [NaN], y: [NaN], angle: [NaN] });
      this.missed ??= page.drawn("g", { class: "misses", "aria-hidden": "true", "data-tool": "" });
      this.svg.querySelector(".parts").before(this.missed);
      this.svg.classList.add("partly");
      this.parts.forEach((part, index) => part.classList.toggle("missing", !known[this.data.parts[index][0]]));
      this.missed.replaceChildren(...circles.map(({ middle, radius }) => {
        const [cx, cy] = this.paper(middle);
        return page.drawn("circle", { cx, cy, r: radius * this.data.window.scale });
      }));
      this.carry(links, 0, this.seen((letter) => place(letter)));
    }
    move(k) {
      this.carry(this.links, k, this.seen((letter) => this.place(letter, k)));
    }
    // all parts to where links have them; `seen` are the points' places on paper
    carry(links, k, seen) {
      const numbers = [];
      this.parts.forEach((part, index) => {
        const box = this.letters.boxes[index], name = this.letters.size !== 1 && box && !box.letter ? box : null;
        if (part.classList.contains("missing")) return;
        const placed = this.placement(links, this.data.parts[index], k, name, box?.letter ? this.letters.grown(box) : 1);
        // the frame's parts stay where they are
        if (placed !== this.placed[index]) part.setAttribute("transform", placed);
        this.placed[index] = placed;
        if (box && !box.letter && !part.classList.contains("missing")) numbers.push(this.numberAt(links, index, k, box, name));
      });
      this.letters.place(numbers, seen);
    }
    numberAt(links, index, k, box, name) {
      const [link, px, py] = this.data.parts[index], at = this.paper(pointAt(links[link], px, py, k)), [x, y] = name ? this.letters.within(at, name) : at;
      const by = this.letters.grown(box);
      return { x: x + by * box.x, y: y + by * box.y, wide: by * box.wide, tall: by * box.tall };
    }
    seen(of) {
      const found = {};
      for (const letter in this.points) {
        const at = of(letter);
        if (at && Number.isFinite(at[0] + at[1])) found[letter] = this.paper(at);
      }
      return found;
    }

    // where a part is at a pose of some links; shapes that turn are drawn as at the first pose of the page
    placement(links, [link, px, py, turns], k, name = null, size = 1) {
      const at = this.paper(pointAt(links[link], px, py, k)), [x, y] = name ? this.letters.within(at, name) : at;
      // y points downward on paper: what turns counterclockwise has a negative angle there
      const turned = turns ? ` rotate(${-(links[link].angle[k] - this.upright[link]) * DEGREE})` : "";
      return `translate(${x} ${y})${turned}${name ? ` scale(${this.letters.grown(name)})` : size !== 1 ? ` scale(${size})` : ""}`;
    }

    // --- the room that the picture takes ----------------------------------------------------------------------------
    // names that have grown and the tips of arrows have room in it; scales stand below
    makeRoom() {
      const { width, height } = this.data.window, { whole } = this.letters;
      // at other dimensions points may go beyond the picture as it was made
      const [first, highest, last, lowest] = this.extent || [0, 0, width, height];
      const box = [Math.min(0, first), Math.min(0, highest), Math.max(width, last), Math.max(height, lowest)];
      const [left, top, right, bottom] = this.overlays.around(box), more = ROOM * Math.max(0, whole - 1);
      this.base = { width: right - left, height: bottom - top };
      this.room = { left: left - more, top: top - more, width: this.base.width + 2 * more, height: this.base.height + 2 * more + this.overlays.below * whole };
      this.seeRoom();
    }
    // what of its room is seen: all of it, unless view_box.js enlarges it
    seeRoom() {
      const { left, top, width, height } = this.room;
      this.svg.setAttribute("viewBox", `${left} ${top} ${width} ${height}`);
      this.letters.isMeasured = false;
    }
    // names are fitted to the size of the picture on the screen
    fit() {
      if (!this.letters.fit()) return;
      this.makeRoom();
      if (this.assembled[this.pose] === 1) this.move(this.pose);
      this.overlays.draw();
    }
  }

  // The players that are mounted, and what each of them has besides, in the order of the scripts that bring it.
  const players = [], attached = [];
  const attach = (run) => {
    attached.push(run);
    players.forEach(run);
  };
  const mount = (root, data) => {
    const player = new Player(root, data);
    players.push(player);
    attached.forEach((run) => run(player));
    return player;
  };
  Object.assign(page, { Player, players, attach, mount });
  for (const root of document.querySelectorAll(".player")) mount(root, JSON.parse(document.getElementById("ck-motion").textContent));
})();
