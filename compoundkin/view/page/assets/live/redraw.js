// Redraw: where every vertex of the sketch is at other dimensions, computed by the program that the painters left
// (redrawn_parts.py), and written where it differs from what is shown.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MARGIN = 26; // around the places of points, as in every picture
  const EDGE = 6; // around lines that reach farther than points
  const SAMPLED = 40; // so many poses tell how far these reach
  const SETTLED = 0.5; // picture units: nearer than this two views are one

  const text = (value) => String(Math.round(value * 100) / 100);
  const pair = (values, k) => `${text(values[k])} ${text(values[k + 1])}`;
  const way = (values) => {
    let d = `M${pair(values, 0)}`;
    for (let k = 2; k < values.length; k += 2) d += `L${pair(values, k)}`;
    return d;
  };

  // --- the outline of points, as link_shapes.outline has it: the ends of a line, or the hull ------------------------
  const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  const farthest = (from, points) => points.reduce((best, p) => (far(p, from) > far(best, from) ? p : best));
  const half = (points) => {
    const chain = [];
    for (const p of points) {
      while (chain.length > 1 && turn(chain[chain.length - 2], chain[chain.length - 1], p) <= 0) chain.pop();
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  const outline = (values, { same, line }) => {
    const found = [];
    for (let k = 0; k < values.length; k += 2) {
      const p = [values[k], values[k + 1]];
      if (found.every((other) => far(p, other) > same)) found.push(p);
    }
    if (found.length < 3) return found;
    const first = farthest(found[0], found), second = farthest(first, found), length = far(first, second);
    if (Math.max(...found.map((p) => Math.abs(turn(first, second, p)) / length)) < line) return [second, first];
    found.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    return [...half(found), ...half(found.reverse())];
  };

  // what is written of a shape, by its kind: attributes and their texts
  const DRAWN = {
    lines: (lines, shape) => ({ d: lines.map(way).join("") + shape.end }),
    outline: ([values], shape, sizes) => {
      const corners = outline(values, sizes), bar = corners.length < 3;
      const d = corners.length ? way(corners.flat()) + (bar ? "" : "Z") : "";
      return { d, class: shape.style.replace(/\bck-(bar|plate)(?=\d)/, bar ? "ck-bar" : "ck-plate") };
    },
    row: ([[x, y, dx, dy, sx, sy, count]]) => {
      let d = "";
      for (let k = 0; k < Math.min(Math.round(count), 9999); k++) {
        const at = [x + k * dx, y + k * dy];
        d += `M${pair(at, 0)}L${text(at[0] + sx)} ${text(at[1] + sy)}`;
      }
      return { d };
    },
    round: ([[cx, cy, r]]) => ({ cx: text(cx), cy: text(cy), r: text(Math.abs(r)) }),
    bow: ([[x, y, toX, toY, r]], shape) => ({ d: `M${text(x)} ${text(y)}A${text(r)} ${text(r)} 0 0 ${shape.sweep} ${text(toX)} ${text(toY)}` }),
  };

  class Redraw {
    constructor(design) {
      const { player } = design, data = player.data.live.redraw;
      Object.assign(this, { design, player, data });
      this.machine = new page.Machine(data.program, 1);
      this.along = data.least.length ? new page.Machine(data.courses, player.poses) : null;
      this.least = new Float64Array(data.least.length);
      const index = new Map(player.links.map((link, k) => [link.name, k]));
      this.poses = data.poses.map(([name, part]) => [player.links[index.get(name)], part]);
      this.shapes = player.parts.flatMap((part, k) => this.of(part, k, data.parts[k][1]));
      this.extent = null;
      design.on("change", () => this.follow());
      design.on("commit", () => this.settle());
    }
    // the shapes of a part that change: their elements, and what stays of them
    of(part, index, shapes) {
      if (!shapes.length) return [];
      const elements = part.querySelectorAll("path, circle, text");
      return shapes.map(([k, kind, lines]) => {
        const element = elements[k], d = element.getAttribute("d") || "";
        const sweep = kind === "bow" ? d.match(/0 0 ([01])/)[1] : "";
        return { element, index, kind, lines, points: [], style: element.getAttribute("class") || "", end: d.endsWith("Z") ? "Z" : "", sweep, shown: {} };
      });
    }

    // --- the numbers --------------------------------------------------------------------------------------------------
    // how far slides go along the motion as it is now
    courses() {
      const { along, data, player } = this;
      const { length } = along;
      along.take(this.design.numbers);
      this.poses.forEach(([link, part], row) => {
        const out = along.rows[row];
        if (!link) out.fill(NaN);
        else if (part === "cos" || part === "sin") for (let k = 0; k < length; k++) out[k] = Math[part](link.angle[k]);
        else out.set(link[part]);
      });
      along.run(0, along.count);
      data.least.forEach((place, j) => {
        const values = along.row(place, 0);
        let least = Infinity;
        for (let k = 0; k < length; k++) if (player.assembled[k] === 1 && values[k] < least) least = values[k];
        // where nothing is assembled guides stay as long as they were
        if (least < Infinity) this.least[j] = least;
      });
    }
    compute() {
      if (this.along) this.courses();
      const { numbers } = this.design, all = new Float64Array(numbers.length + this.least.length);
      all.set(numbers);
      all.set(this.least, numbers.length);
      this.machine.take(all);
    }

    // --- the picture --------------------------------------------------------------------------------------------------
    follow() {
      this.compute();
      const { player, machine, data } = this, { numbers } = machine;
      for (const shape of this.shapes) {
        const lines = shape.lines.map((line) => line.map((place) => numbers[place]));
        if (!lines.every((line) => line.every(Number.isFinite))) continue;
        const drawn = DRAWN[shape.kind](lines, shape, data.outline);
        shape.points = shape.kind === "lines" || shape.kind === "outline" ? lines.flat() : [];
        for (const name in drawn) {
          if (drawn[name] === shape.shown[name]) continue;
          shape.shown[name] = drawn[name];
          shape.element.setAttribute(name, drawn[name]);
        }
      }
      data.parts.forEach(([[x, y]], k) => {
        const part = player.data.parts[k];
        [part[1], part[2]] = [numbers[x], numbers[y]];
      });
      if (player.assembled[player.pose] === 1) player.move(player.pose);
      else player.part(player.pose);
      this.grow();
    }

    // --- the view: it grows while something changes, and settles with the step ----------------------------------------
    grow() {
      // under a pointer that drags, the picture stays where it is
      const found = this.player.root.querySelector(".handle.held") ? null : this.reach();
      if (!found) return;
      const { extent } = this;
      this.extent = extent ? extent.map((edge, k) => (k < 2 ? Math.min : Math.max)(edge, found[k])) : found;
      this.show();
    }
    settle() {
      this.extent = this.design.isChanged ? this.reach() : null;
      this.player.extent = this.extent;
      this.room();
    }
    show() {
      const { extent, player } = this, before = player.extent;
      if (before === extent || (before && extent && before.every((edge, k) => Math.abs(edge - extent[k]) < SETTLED))) return;
      player.extent = extent;
      this.room();
    }
    // the scales of vectors stand at the lower edge of it
    room() {
      this.player.makeRoom();
      this.player.overlays.draw();
    }
    // left, top, right and bottom of all places of points on the picture
    reach() {
      const { player } = this, box = [Infinity, Infinity, -Infinity, -Infinity];
      const holds = (x, y, room) => {
        if (x - room < box[0]) box[0] = x - room;
        if (y - room < box[1]) box[1] = y - room;
        if (x + room > box[2]) box[2] = x + room;
        if (y + room > box[3]) box[3] = y + room;
      };
      for (const letter in player.points) {
        for (let k = 0; k < player.poses; k++) {
          if (player.assembled[k] === 1) holds(...player.paper(player.place(letter, k)), MARGIN);
        }
      }
      const step = Math.max(1, Math.ceil(player.poses / SAMPLED));
      for (const { index, points } of this.shapes) {
        const [link, px, py, turns] = player.data.parts[index], { angle } = player.links[link];
        for (let k = 0; points.length && k < player.poses; k += step) {
          if (player.assembled[k] !== 1) continue;
          const [x, y] = player.paper(player.at(link, px, py, k)), by = turns ? angle[k] - player.upright[link] : 0;
          const c = Math.cos(by), s = -Math.sin(by); // y points downward on paper
          for (let j = 0; j < points.length; j += 2) holds(x + c * points[j] - s * points[j + 1], y + s * points[j] + c * points[j + 1], EDGE);
        }
      }
      return box.every(Number.isFinite) ? box : null;
    }
  }

  page.Redraw = Redraw;
  page.attach(({ design }) => { if (design && design.player.data.live.redraw) design.redraw = new Redraw(design); });
})();
