// Forces over the sketch: arrows to one scale and arcs of moments, with their names.
(() => {
  "use strict";
  const page = window.compoundkin;
  const KEY = 22; // the length of an arrow that tells a colour
  const SWEEP = 2.7, ROUND = 19, AROUND_DRIVER = 34, NEXT = 7, HEAD = 10, HALF = 3.6; // arcs, as in every other picture
  const FAINT = 0.01; // a moment below this part of its greatest has no arc
  const NAMED = 14; // a shorter arrow has no name
  const HALF_LETTER = 3.3, TALL = 6, GAP = 3; // of a name: half a letter, half its height, from what it names
  const TURNS = 16; // directions in which an arc is tried around its place
  const ON_ARROW = 2, ON_LINK = 1; // what an arrow in an arc costs beside its own link
  const EDGE = 2, PIN = 6;

  const unit = ([x, y]) => { const size = Math.hypot(x, y); return size > 1e-9 ? [x / size, y / size] : [0, -1]; };

  class ForceOverlay {
    constructor(overlays) {
      const { player } = overlays, { data } = player, open = (text) => page.unpacked(text, data.poses);
      Object.assign(this, { overlays, player, data: data.forces, layer: overlays.layers.forces });
      const placed = (one, index) => ({ ...one, index, at: one.at && one.at.map(open) });
      this.forces = (data.forces?.arrows ?? []).map((one, k) => ({ ...placed(one, k), force: one.force.map(open) }));
      this.moments = (data.forces?.moments ?? []).map((one, k) => ({ ...placed(one, k), moment: open(one.moment) }));
      for (const one of this.moments) one.most = one.moment.reduce((most, value) => Math.max(most, Math.abs(value) || 0), 0);
    }
    // of other dimensions where the page's program has them
    get isShown() {
      return Boolean(this.data) && this.overlays.shown.has("forces") && (!this.overlays.isChanged || this.isLive);
    }
    get isLive() {
      return Boolean(this.player.data.live?.forces);
    }
    // those of other dimensions, computed when they are first shown; null for the ones that the page came with
    get changed() {
      if (!this.overlays.isChanged) return null;
      const { path, design: { solved } } = this.player;
      if (this.of !== solved) Object.assign(this, { of: solved, found: path.acting(solved) });
      return this.found;
    }
    // the rows below the picture: style, words, length of the arrow
    get keys() {
      const { text, length, kinds, turning } = this.data;
      const scale = this.forces.length ? [["drive", text, length]] : [];
      const arcs = this.moments.length ? [["drive", `arcs: moments in ${turning}, not to scale`, 0]] : [];
      return [...scale, ...Object.entries(kinds).map(([kind, words]) => [kind, words, KEY]), ...arcs];
    }
    // where it acts: at a point of its link, or where it was told for every pose
    acts(one, k = this.player.pose) {
      const at = this.own(one)?.at ?? one.at;
      return at ? at.map((values) => values[k]) : this.player.at(one.link, one.x, one.y, k);
    }
    // an arrow or an arc as it is with other dimensions
    own({ index, moment }) {
      return this.changed?.[moment ? "arcs" : "arrows"][index];
    }
    force(one, k = this.player.pose) {
      const { scale } = this.data, [x, y] = (this.own(one) ?? one).force;
      return [this.player.paper(this.acts(one, k)), [x[k] * scale, -y[k] * scale]];
    }
    moment(one, k = this.player.pose) {
      return (this.own(one) ?? one).moment[k];
    }
    // where each arrow begins and which way it goes at every pose, with the room of its name; arcs as far as they reach
    *arrows() {
      const { poses, letters: { size } } = this.player;
      for (const one of this.forces) {
        const room = size * (2 * HALF_LETTER * one.name.length + GAP), tall = size * 2 * (TALL + GAP);
        for (let k = 0; k < poses; k++) {
          const [at, [dx, dy]] = this.force(one, k), [ex, ey] = unit([dx, dy]), named = Math.hypot(dx, dy) >= NAMED;
          yield [at, named ? [dx + ex * room, dy + ey * tall] : [dx, dy]];
        }
      }
      for (const one of this.moments) {
        const far = this.radius(one) + size * 2 * TALL;
        for (let k = 0; k < poses; k++) {
          if (!this.turns(one, k)) continue;
          const at = this.player.paper(this.acts(one, k));
          for (const way of [[far, far], [-far, -far]]) yield [at, way];
        }
      }
    }
    turns(one, k = this.player.pose) {
      return Math.abs(this.moment(one, k)) >= FAINT * one.most && one.most > 0;
    }
    radius({ driver }) {
      return driver ? AROUND_DRIVER : ROUND;
    }

    draw() {
      const { overlays, layer } = this, { shortest, unit: forces, turning, scale } = this.data;
      const arrows = this.forces.map((one) => [one, ...this.force(one)]).filter(([, , way]) => Math.hypot(...way) >= shortest);
      const taken = [...(overlays.shown.has("names") ? overlays.centres.taken() : []), ...this.pins()];
      const drawn = (one, value, of) => {
        const group = page.drawn("g", {}, layer);
        page.drawn("title", {}, group).textContent = `${one.told}: ${page.withUnit(Math.abs(value), of)}`;
        return group;
      };
      for (const [one, at, way] of arrows) overlays.arrow(at, way, one.kind, drawn(one, Math.hypot(...way) / scale, forces));
      const around = [];
      for (const one of this.moments) {
        const at = this.player.paper(this.acts(one));
        if (!this.turns(one) || !Number.isFinite(at[0] + at[1])) continue;
        const radius = this.radius(one) + NEXT * around.filter((other) => Math.hypot(other[0] - at[0], other[1] - at[1]) < 1).length;
        around.push(at);
        const outward = this.free(one, at, radius, arrows);
        this.arc(at, outward, radius, Math.sign(this.moment(one)), one.kind, drawn(one, this.moment(one), turning));
        this.name(one, taken, this.besides([at[0] + outward[0] * radius, at[1] + outward[1] * radius], outward, one.name));
      }
      for (const [one, [x, y], [dx, dy]] of arrows) {
        if (Math.hypot(dx, dy) < NAMED) continue;
        const e = unit([dx, dy]), places = this.besides([x + dx, y + dy], e, one.name);
        // else beside the shaft
        for (const part of [0.75, 0.5]) for (const side of [1, -1]) places.push(...this.besides([x + part * dx, y + part * dy], [-e[1] * side, e[0] * side], one.name).slice(0, 1));
        this.name(one, taken, places);
      }
      const before = overlays.vectors.length, { keys } = this;
      keys.forEach(([kind, words, long], row) => overlays.key(kind, words, long, before + keys.length - row - 0.5, layer));
    }
    // no name stands on a pin
    pins() {
      const { player } = this;
      return Object.keys(player.points).map((letter) => player.paper(player.place(letter))).map(([x, y]) => ({ x, y, half: PIN }));
    }
    // where the middle of an arc crosses the fewest arrows and bars of its link
    free(one, [x, y], radius, arrows) {
      const { player } = this, crossed = [];
      const cross = (dx, dy, weight) => { if (Math.hypot(dx, dy) > radius) crossed.push([unit([dx, dy]), weight]); };
      for (const end of one.ends) {
        const [px, py] = player.paper(player.at(one.body, ...end, player.pose));
        cross(px - x, py - y, ON_LINK);
      }
      for (const [, at, way] of arrows) if (Math.hypot(at[0] - x, at[1] - y) < radius) cross(...way, ON_ARROW);
      const inward = crossed.length ? crossed[0][0] : [0, -1];
      let best = inward.map((c) => -c), least = Infinity;
      for (let k = 0; k < TURNS; k++) {
        const c = Math.cos((2 * Math.PI * k) / TURNS), s = Math.sin((2 * Math.PI * k) / TURNS);
        const tried = [-inward[0] * c + inward[1] * s, -inward[1] * c - inward[0] * s];
        const cost = crossed.reduce((sum, [way, weight]) => sum + weight * Math.max(0, 1 - Math.acos(Math.max(-1, Math.min(1, way[0] * tried[0] + way[1] * tried[1]))) / (SWEEP / 2 + 0.3)), 0);
        if (cost < least - 1e-9) [best, least] = [tried, cost];
      }
      return best;
    }
    // an arc with a head around a place; counterclockwise is clockwise in coordinates whose y points downward
    arc([x, y], outward, radius, sense, kind, group) {
      const middle = Math.atan2(outward[1], outward[0]), sweep = -sense * SWEEP, back = (Math.sign(sweep) * HEAD) / radius;
      const on = (angle, r = radius) => [x + r * Math.cos(angle), y + r * Math.sin(angle)];
      const start = on(middle - sweep / 2), stop = middle + sweep / 2, end = on(stop - 0.8 * back);
      page.drawn("path", { class: `ck-${kind}`, fill: "none", d: `M${start.join(" ")}A${radius} ${radius} 0 0 ${sweep > 0 ? 1 : 0} ${end.join(" ")}` }, group);
      const sides = [on(stop), on(stop - back, radius + HALF), on(stop - back, radius - HALF)].map((p) => p.join(" "));
      page.drawn("path", { class: `ck-${kind}-head`, d: `M${sides.join("L")}Z` }, group);
    }
    // places for a name beside a place, first of all ahead
    besides([x, y], e, name) {
      const { size } = this.player.letters, half = HALF_LETTER * size * name.length, tall = TALL * size;
      const reach = (c, s) => Math.abs(c) * half + Math.abs(s) * tall + GAP;
      return [0, 0.6, -0.6, 1.2, -1.2].map((turn) => {
        const c = e[0] * Math.cos(turn) - e[1] * Math.sin(turn), s = e[0] * Math.sin(turn) + e[1] * Math.cos(turn), far = reach(c, s);
        return { x: x + c * far, y: y + s * far, half };
      });
    }
    // the first place that covers no other name, else the one that covers fewest
    name(one, taken, places) {
      const { room, letters: { size } } = this.player;
      let best = null, least = Infinity;
      for (const at of places) {
        const outside = at.x - at.half < room.left + EDGE || at.x + at.half > room.left + room.width - EDGE || at.y - TALL < room.top;
        const cost = 10 * outside + taken.filter((other) => Math.abs(other.x - at.x) < other.half + at.half && Math.abs(other.y - at.y) < 2 * TALL * size).length;
        if (cost < least) [best, least] = [at, cost];
        if (!cost) break;
      }
      taken.push(best);
      for (const style of [`ck-halo ck-${one.kind}-name`, `ck-${one.kind}-name`]) this.overlays.text(one.name, best.x, best.y, style, "middle", this.layer);
    }
  }

  page.ForceOverlay = ForceOverlay;
})();
