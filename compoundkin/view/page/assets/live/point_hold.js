// A point that is held: where it may go, the coordinates that it has there on its links, what is told of it.
// Its links stay where they are at the pose shown: only the point moves on them.
(() => {
  "use strict";
  const page = window.compoundkin;
  const DEGREE = 180 / Math.PI;

  // beside the pointer four digits are enough
  const short = (value, unit) => page.withUnit(Number(value.toPrecision(4)), unit);
  // a pose of a link as it is used here: its origin, cosine and sine of its angle
  const poseOf = ({ x, y, angle }, k) => ({ x: x[k], y: y[k], c: Math.cos(angle[k]), s: Math.sin(angle[k]) });
  const placeOn = ({ x, y, c, s }, px, py) => [x + c * px - s * py, y + s * px + c * py];
  const inside = ({ x, y, c, s }, [wx, wy]) => [c * (wx - x) + s * (wy - y), c * (wy - y) - s * (wx - x)];

  // in which direction a point runs on a link: to where it is farthest from the pose k, and which pose that is
  page.guideOf = (player, link, letter, k) => {
    const from = inside(poseOf(player.links[link], k), player.place(letter, k));
    let best = [0, 0], far = 0, to = k;
    for (let at = 0; at < player.poses; at++) {
      const [x, y] = inside(poseOf(player.links[link], at), player.place(letter, at));
      const away = Math.hypot(x - from[0], y - from[1]);
      if (away > far) [far, best, to] = [away, [x - from[0], y - from[1]], at];
    }
    const { c, s } = poseOf(player.links[link], k);
    return far > 0 ? { along: [(c * best[0] - s * best[1]) / far, (s * best[0] + c * best[1]) / far], to } : null;
  };

  class PointHold {
    constructor(drag, one) {
      const { player } = drag, { name, links, on } = one.data, k = player.pose;
      Object.assign(this, { drag, one, player, design: player.design });
      this.start = this.now = player.place(name);
      this.poses = links.map((link) => ({ link, ...poseOf(player.links[link], k) }));
      // its coordinates where it was taken hold of: with one length alone the others are these
      this.taken = Object.fromEntries(this.poses.flatMap(({ link }) => ["x", "y"].map((part) => `${player.data.links[link].name}.${name}.${part}`)).map((key) => [key, player.design.value(key)]));
      this.guide = on === undefined ? null : page.guideOf(player, on, name, k)?.along;
      // lines from other points of its links through where it was
      this.rays = this.poses.filter(({ link }) => !this.isFrame(link)).flatMap((pose) => this.others(pose.link).map(({ letter, x, y }) => ({ pose, letter, from: placeOn(pose, x, y) })))
        .map((ray) => ({ ...ray, away: [this.start[0] - ray.from[0], this.start[1] - ray.from[1]] }))
        .map((ray) => ({ ...ray, size: Math.hypot(...ray.away) })).filter(({ size }) => size > 0)
        .map(({ away, size, ...ray }) => ({ ...ray, size, along: away.map((part) => part / size) }));
      const letters = Object.keys(player.points).filter((letter) => letter !== name);
      this.places = [...letters.map((letter) => player.place(letter, k)), this.before(name, k)]
        .filter(([x, y]) => Number.isFinite(x + y) && Math.hypot(x - this.start[0], y - this.start[1]) > 0);
    }
    isFrame(link) {
      return this.player.data.links[link].name === "frame";
    }
    others(link) {
      return page.pointsOf(this.player, link).filter(({ letter }) => letter !== this.one.name);
    }
    // where the point was on the original
    before(letter, k) {
      const { player, design } = this, own = design.carried.get(letter)[0];
      const index = player.data.links.findIndex(({ name }) => name === own.link);
      return player.given ? placeOn(poseOf(player.given.links[index], k), design.own[own.x], design.own[own.y]) : this.start;
    }

    move(world, free, only = false) {
      if (only && this.rays.length) return this.lengthen(world, free);
      const { pixel } = this.drag.handles, step = page.gridStep(pixel);
      let found = { at: world, lines: [] };
      if (this.guide) found = { at: this.onGuide(world, free ? 0 : step), lines: [] };
      else if (!free) found = page.snapped(world, { step, pixel, others: this.places, rays: this.rays });
      this.put(found);
    }
    // only one length: that of the link along which the pointer goes; other links keep theirs, and the mechanism closes anew
    lengthen(world, free) {
      const away = [world[0] - this.start[0], world[1] - this.start[1]], along = (ray) => away[0] * ray.along[0] + away[1] * ray.along[1];
      const ray = this.rays.reduce((best, one) => (Math.abs(along(one)) > Math.abs(along(best)) ? one : best));
      const step = free ? 0 : page.gridStep(this.drag.handles.pixel), wanted = ray.size + along(ray), length = Math.max(step ? page.toStep(wanted, step) : wanted, step || ray.size * 1e-3);
      const at = ray.from.map((from, part) => from + length * ray.along[part]), { name } = this.player.data.links[ray.pose.link];
      this.design.change({ ...this.taken, ...this.kept(this.on(ray.pose, at)) });
      this.now = at;
      this.drag.numbers.show(this.one, { at, lines: [ray.from] }, [`only ${name} ${ray.letter}${this.one.name}: ${short(length, this.player.data.unit)}`]);
    }
    // the coordinates on a link of a place
    on(pose, at) {
      const { width, height, scale } = this.player.data.window, fine = page.finest(Math.max(width, height) / scale);
      const base = `${this.player.data.links[pose.link].name}.${this.one.name}`, [x, y] = inside(pose, at);
      return { [`${base}.x`]: page.toStep(x, fine), [`${base}.y`]: page.toStep(y, fine) };
    }
    // with what is locked: a length and an angle that end at the point keep their values, others keep the point
    kept(values) {
      const { design, one: { name } } = this, of = (key) => values[key] ?? design.value(key);
      for (const row of this.player.locks || []) {
        if (!row.letters.includes(name) || !(`${row.owner}.${name}.x` in values)) continue;
        if (row.moved === name) Object.assign(values, row.set(row.get(design.value.bind(design)), of));
        else for (const part of ["x", "y"]) values[`${row.owner}.${name}.${part}`] = design.value(`${row.owner}.${name}.${part}`);
      }
      return values;
    }
    step(way, by) {
      const step = page.gridStep(this.drag.handles.pixel) * by;
      const to = this.now.map((value, part) => (way[part] ? page.toStep(value + way[part] * step, step) : value));
      this.put({ at: this.guide ? this.onGuide(to, 0) : to, lines: [] });
    }
    put(found) {
      this.now = found.at;
      this.design.change(this.kept(Object.assign({}, ...this.poses.map((pose) => this.on(pose, found.at)))));
      this.drag.numbers.show(this.one, found, this.lengths());
    }
    onGuide([x, y], step) {
      const { start, guide } = this, main = Math.abs(guide[0]) >= Math.abs(guide[1]) ? 0 : 1;
      let along = guide[0] * (x - start[0]) + guide[1] * (y - start[1]);
      if (step) along = (page.toStep(start[main] + along * guide[main], step) - start[main]) / guide[main];
      return [start[0] + along * guide[0], start[1] + along * guide[1]];
    }
    // of each link on which it moves: how far it is from the other points, and in which direction on the link
    lengths() {
      const { player } = this, { name, links } = this.one.data, { unit } = player.data;
      return links.filter((link) => !this.isFrame(link) || links.length === 1).flatMap((link) => {
        const own = page.pointsOf(player, link).find(({ letter }) => letter === name);
        return this.others(link).map(({ letter, x, y }) => {
          const angle = Math.atan2(own.y - y, own.x - x) * DEGREE;
          return `${player.data.links[link].name} ${letter}${name} ${short(Math.hypot(own.x - x, own.y - y), unit)}, ${short(angle, "deg")}`;
        });
      });
    }
    drop() {
      this.design.commit(`${this.one.name} moved`);
    }
    takeBack() {
      this.design.revert();
    }
  }

  page.PointHold = PointHold;
})();
