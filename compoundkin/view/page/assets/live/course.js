// The course of a quantity along a motion, between the poses too: the mechanism's program is asked wherever it takes.
(() => {
  "use strict";
  const page = window.compoundkin;
  const TURN = 2 * Math.PI;
  const ROUNDING = 1e-12; // values nearer than this part of what is natural for them are one
  const ADDED = 0.5; // second differences by which a curve may rise beyond a pose
  const SAME_JUMP = 1e-7; // places so near are both sides of a jump
  const BESIDE = 2e-9; // a jump is so near to its pose, of a place
  const STEPS = 4, WIDE = 1e-5; // to a zero of a length, and for its slopes
  const HALVINGS = 48;
  const NEAR_LIMIT = [1e-3, 1e-4], GROWTH = 3; // rates that grow so between, by the root of the distance, have no limit
  const SAME_POSE = 1e-9; // of the size, or radians

  // One design: what its drivers do between the poses, and where it can be assembled.
  class Courses {
    constructor(design) {
      const { path, numbers, solved, player } = design;
      Object.assign(this, { path, numbers, solved, player, last: player.poses - 1, known: new Map() });
      this.time = player.along.name === "time" ? player.along.values : null;
      this.wrapped = Object.fromEntries(path.outputs.map(({ name, wrapped }) => [name, wrapped]));
      this.jumps = paired(player.data.plots?.jumps ?? []);
    }
    // what is natural for a length or an angle, or a rate of it
    scale(kind, order) {
      const known = this.player.data.plots?.rounding[kind];
      return known ? known[order] / ROUNDING : 1;
    }
    // the largest force in any pair at the median pose: next to singular poses forces grow without limit
    get largestForce() {
      return (this.forced ??= median((this.path.data.forces?.pairs ?? []).map((name) => this.solved.outputs[name]).filter(Boolean), this.last + 1));
    }
    isOfForces(name) {
      return (this.path.data.forces?.outputs ?? []).some((one) => one.name === name);
    }
    // where it is known what the drivers do: at poses, and on both sides of jumps in the place of a pose that is one
    get knots() {
      if (this.tied) return this.tied;
      const { drives } = this.path, jumps = this.player.data.plots?.jumps ?? [];
      const time = (s) => { const k = Math.min(Math.floor(s), this.last - 1); return this.time[k] + (s - k) * (this.time[k + 1] - this.time[k]); };
      const sides = jumps.map(({ place, drives: rows }) => ({ place, time: time(place), rows }));
      const poses = Array.from(this.time, (at, k) => ({ place: k, time: at, rows: drives.map((rows) => rows.map((row) => row[k])) }));
      const kept = poses.filter(({ place }) => !jumps.some((jump) => Math.abs(jump.place - place) < SAME_JUMP));
      return (this.tied = [...kept, ...sides].sort((a, b) => a.place - b.place));
    }
    // what the drivers do at a place: between poses in proportion; in time by a polynomial with their rates
    drives(s) {
      if (this.time) {
        const { knots } = this, next = Math.min(Math.max(knots.findIndex(({ place }) => place >= s), 1), knots.length - 1);
        const [a, b] = [knots[next - 1], knots[next]], at = [a, b].find(({ place }) => place === s), t = (s - a.place) / (b.place - a.place);
        return at ? at.rows : a.rows.map((row, d) => page.quintic(b.time - a.time, t, row.map((value, order) => [value, b.rows[d][order]])));
      }
      const k = Math.min(Math.max(Math.floor(s), 0), this.last - 1), t = s - k;
      return this.path.drives.map((rows) => rows.map((row) => row[k] + t * (row[k + 1] - row[k])));
    }
    at(s) {
      const k = Math.round(Math.min(Math.max(s, 0), this.last));
      return this.path.at(this.numbers, this.drives(s), this.solved, k, s);
    }
    isAssembled(s) {
      return Boolean(this.at(s).assembled);
    }
    // where it stops being assembled between a pose and one beside it
    limit(good, bad) {
      for (let n = 0; n < HALVINGS; n++) {
        const middle = (good + bad) / 2;
        if (this.isAssembled(middle)) good = middle; else bad = middle;
      }
      return good;
    }
    // stretches on which everything is smooth: [from, to, pose or -1 at both, whether it ends there]
    get stretches() {
      if (this.found) return this.found;
      const { assembled } = this.solved, found = [];
      for (let k = 0; k <= this.last; k++) {
        if (!assembled[k]) continue;
        if (k > 0 && !assembled[k - 1]) found.push({ low: this.limit(k, k - 1), high: k, ends: [true, false] });
        if (k < this.last && assembled[k + 1]) found.push({ low: k, high: k + 1, ends: [false, false] });
        if (k < this.last && !assembled[k + 1]) found.push({ low: k, high: this.limit(k, k + 1), ends: [false, true] });
      }
      let whole = found;
      for (const [before, after] of this.jumps) {
        const [from, to] = [before ?? after, after ?? before];
        whole = whole.flatMap((one) => (one.low > to || one.high < from ? [one] : [
          { low: one.low, high: before ?? -Infinity, ends: [one.ends[0], false] },
          { low: after ?? Infinity, high: one.high, ends: [false, one.ends[1]] },
        ].filter(({ low, high }) => high > low)));
      }
      return (this.found = whole.sort((a, b) => a.low - b.low));
    }
    get closes() {
      const { links, assembled } = this.solved, { last } = this, size = this.scale("length", 0);
      const turned = (angle) => Math.abs(Math.sin((angle[last] - angle[0]) / 2));
      return last > 1 && Boolean(assembled[0] && assembled[last]) && links.every(({ x, y, angle }) =>
        Math.hypot(x[last] - x[0], y[last] - y[0]) <= 100 * SAME_POSE * size && turned(angle) <= 100 * SAME_POSE);
    }
    // a quantity by its name, a part of a vector too; null where the program does not tell it
    of(name) {
      if (!this.known.has(name)) this.known.set(name, this.named(name));
      return this.known.get(name);
    }
    named(name) {
      const { outputs } = this.solved, dot = name.lastIndexOf(".");
      if (outputs[name] && "" in outputs[name]) return new Course(this, name, "");
      const [vector, part] = [name.slice(0, dot), name.slice(dot + 1)];
      return outputs[vector] && ("x" in outputs[vector]) && ["x", "y", "length"].includes(part) ? new Course(this, vector, part) : null;
    }
  }

  const median = (forces, poses) => {
    const sizes = Float64Array.from({ length: poses }, (_, k) => forces.reduce((most, { x, y }) => {
      const size = Math.hypot(x[k], y[k]);
      return Number.isFinite(size) && size > most ? size : most;
    }, 0)).sort();
    return (sizes[(poses - 1) >> 1] + sizes[poses >> 1]) / 2 || sizes[poses - 1];
  };

  // both sides of jumps: [place before, place after], one of them null at an end of the motion
  const paired = (jumps) => {
    const [ends, begins] = [false, true].map((kind) => jumps.filter((one) => one.begins === kind).map(({ place }) => place));
    const beside = (list, place) => list.find((one) => Math.abs(one - place) < SAME_JUMP) ?? null;
    return [...ends.map((place) => [place, beside(begins, place)]), ...begins.filter((place) => beside(ends, place) === null).map((place) => [null, place])];
  };

  class Course {
    constructor(whole, name, part) {
      Object.assign(this, { whole, name, part });
      const parts = whole.solved.outputs[name];
      this.isLength = part === "length";
      this.values = this.isLength ? parts.x.map((x, k) => Math.hypot(x, parts.y[k])) : parts[part];
    }
    at(s) {
      const { whole, part } = this, k = Math.round(s);
      if (k === s) return this.values[k];
      const told = whole.at(s).outputs[this.name], value = this.isLength ? Math.hypot(told.x, told.y) : told[part];
      if (!whole.wrapped[this.name]) return value;
      const near = this.values[k] === this.values[k] ? k : k > s ? Math.floor(s) : Math.ceil(s);
      return value + TURN * Math.round((this.values[near] - value) / TURN);
    }
    // where it is smooth: forces are switched by loads that act one way only
    get stretches() {
      if (this.smooth) return this.smooth;
      const { stretches } = this.whole, cuts = this.whole.isOfForces(this.name) ? page.Curve.switches([Array.from(this.values)]) : new Set();
      return (this.smooth = stretches.flatMap((one) => {
        if (!cuts.has(one.low) || one.high !== one.low + 1) return [one];
        const [before, after] = this.switch(one.low, one.high);
        return [{ ...one, high: before, ends: [one.ends[0], false] }, { ...one, low: after, ends: [false, one.ends[1]] }];
      }));
    }
    // both sides of a switch: the half on which it steps further
    switch(low, high) {
      let [a, b] = [this.at(low), this.at(high)];
      for (let n = 0; n < HALVINGS; n++) {
        const middle = (low + high) / 2, value = this.at(middle);
        if (middle === low || middle === high) break;
        if (Math.abs(value - a) > Math.abs(b - value)) [high, b] = [middle, value]; else [low, a] = [middle, value];
      }
      return [low, high];
    }
    // the greatest of the values times a sign, and where it is first taken; `scale` tells what is rounding
    greatest(sign, scale) {
      const { stretches, values } = this, offers = [];
      const bend = (k) => {
        const j = Math.min(Math.max(k, 1), this.whole.last - 1);
        return Math.abs(values[j - 1] - 2 * values[j] + values[j + 1]);
      };
      // not known beside a place where it stops being assembled
      const rise = (low, high) => {
        const known = [Math.floor(low), Math.ceil(high)].map(bend).filter((one) => one === one);
        return known.length ? ADDED * Math.max(...known) : Infinity;
      };
      const whole = stretches.map(({ low, high, ends }) => {
        const [a, b] = [low, high].map((s) => sign * this.at(s));
        return { low, high, values: [a, b], bound: ends[0] || ends[1] ? Infinity : Math.max(a, b) + rise(low, high) };
      });
      let best = -Infinity, size = scale;
      for (const { values: [a, b] } of whole) {
        best = Math.max(best, a === a ? a : best, b === b ? b : best);
        for (const one of [a, b]) if (Number.isFinite(one)) size = Math.max(size, Math.abs(one));
      }
      const slack = ROUNDING * size;
      for (const { low, high, values: [a, b], bound } of whole) {
        offers.push({ at: low, value: a }, { at: high, value: b });
        if (!(bound >= best) || (a >= best - slack && b >= best - slack)) continue;
        const parts = [0, 0.25, 0.5, 0.75, 1].map((t) => low + t * (high - low));
        const samples = parts.map((s, k) => (k === 0 ? a : k === 4 ? b : sign * this.at(s)));
        const top = samples.reduce((most, value, k) => (value > samples[most] || samples[most] !== samples[most] ? k : most), 0);
        // highest at an end, from where it falls
        const inward = top === 0 ? low + WIDE : top === 4 ? high - WIDE : NaN;
        if (inward === inward && !(sign * this.at(inward) > samples[top])) continue;
        // squares of lengths are smooth where they pass zero
        const goal = (s) => { const value = sign * this.at(s); return this.isLength ? -sign * value * value : -value; };
        const at = page.least(goal, parts[Math.max(0, top - 1)], parts[Math.min(4, top + 1)]);
        offers.push(this.isLength && sign < 0 ? this.zero(at, low, high) : { at, value: sign * this.at(at) });
      }
      for (const one of offers) if (one.value > best) best = one.value;
      const first = offers.filter(({ value }) => value >= best - slack).reduce((a, b) => (b.at < a.at ? b : a), { at: Infinity });
      // both sides of a jump at a pose are that pose
      const at = Math.abs(first.at - Math.round(first.at)) <= BESIDE ? Math.round(first.at) : first.at;
      return { value: sign * best, at, slack };
    }
    // the least length near a place: where it is zero the steps of Gauss and Newton lead there
    zero(start, low, high) {
      let at = start, value = this.at(at);
      for (let n = 0; n < STEPS; n++) {
        const [before, here, after] = [at - WIDE, at, at + WIDE].map((s) => this.whole.at(s).outputs[this.name]);
        const [dx, dy] = ["x", "y"].map((part) => (after[part] - before[part]) / (2 * WIDE));
        const next = Math.min(Math.max(at - (here.x * dx + here.y * dy) / (dx * dx + dy * dy), low), high), found = this.at(next);
        if (!(found < value)) break;
        [at, value] = [next, found];
      }
      return { at, value: -value };
    }
    // both ends of its range; `order` of what is a rate: it may have no limit where the mechanism stops being assembled
    range(order, scale) {
      return (this.ranged ??= this.whole.stretches.length ? this.searched(order, scale) : { none: true });
    }
    searched(order, scale) {
      const [low, high] = [-1, 1].map((sign) => this.greatest(sign, scale));
      const isConstant = high.value - low.value <= Math.max(low.slack, high.slack);
      if (order > 0) this.withoutLimit(low, high);
      return { low, high, isConstant, slack: high.slack };
    }
    withoutLimit(low, high) {
      for (const { low: a, high: b, ends } of this.stretches) {
        ends.forEach((ends, side) => {
          if (!ends) return;
          const [first, second] = NEAR_LIMIT.map((t) => this.at(side ? b - t * t * (b - a) : a + t * t * (b - a)));
          if (!(Math.abs(second) > GROWTH * Math.abs(first) + high.slack)) return;
          const end = second > 0 ? high : low;
          if (Number.isFinite(end.value)) Object.assign(end, { value: second > 0 ? Infinity : -Infinity, at: side ? b : a });
        });
      }
    }
    // where it comes to rest before a pose at which it rests
    rest(k, zero) {
      let [moves, rests] = [k - 1, k];
      for (let n = 0; n < HALVINGS; n++) {
        const middle = (moves + rests) / 2;
        if (Math.abs(this.at(middle)) <= zero) rests = middle; else moves = middle;
      }
      return rests;
    }
    // where it changes its sign, in order
    get crossings() {
      return (this.crossed ??= this.changed());
    }
    changed() {
      const { values, whole } = this, found = [], { last } = whole;
      const most = values.reduce((all, value) => Math.max(all, Math.abs(value) || 0), 0), zero = ROUNDING * 1e3 * most;
      const sign = (value) => (Math.abs(value) <= zero ? 0 : Math.sign(value));
      for (const { low, high } of whole.stretches) {
        let [a, b] = [low, high], [fa, fb] = [this.at(a), this.at(b)];
        if (!(sign(fa) * sign(fb) < 0)) continue; // not known at a limit position either
        found.push(page.root((s) => this.at(s), a, b, fa, fb));
      }
      // a rest begins where it is first zero; one through the seam of a cycle, before its end
      for (let k = 0; k <= last; k++) {
        if (sign(values[k]) !== 0) continue;
        let end = k;
        while (end < last && sign(values[end + 1]) === 0) end++;
        const isRest = end > k, first = Array.from(values).findIndex((value) => sign(value) !== 0);
        const [head, tail] = [whole.closes && k === 0, whole.closes && end === last];
        const before = head ? values.findLast((value) => sign(value) !== 0) : values[k - 1], after = tail ? values[first] : values[end + 1];
        const isTold = head ? sign(values[last - 1]) !== 0 : !(tail && k === last);
        if (first >= 0 && isTold && sign(before) * sign(after) < 0) found.push(isRest && k > 0 ? this.rest(k, zero) : k);
        k = end;
      }
      return found.sort((a, b) => a - b);
    }
  }

  page.Courses = Courses;
})();
