// The states: what a program is given besides dimensions and drivers, carried from design to design and pose to pose.
// They are positions of groups without a closed form, which Newton's steps correct, angles with their full turns, and
// where profiles are touched, which is searched.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const TURN = 2 * Math.PI;
  const STRIDE = 0.05, STRIDES = 64; // how far a dimension goes in one step (parts of the size, or radians), and how often
  const ROUNDS = 10; // Newton's steps, of which three are the rule
  const CLOSED = 1e-9; // the step after such a one reaches rounding
  const LEAP = 0.5; // what moves farther (parts of the size, radians) has left its configuration
  const STRAY = 0.05; // so far from where it was led to, a pose may be of another branch: shorter steps are taken
  const SHORTEST = 1 / 64; // of the way between two poses, or two designs
  const SAMPLES = 360, HALVINGS = 60, RESTS = 1e-15; // places of a profile that are tried; steps from there, and when they end
  const FOUND = 1e-6; // a contact moves on by less (radians): what is left is its square
  const UNEVEN = 0.02; // from pose to pose states go on as in the design before, but for this and the change

  const wrapped = (angle) => angle - TURN * Math.round(angle / TURN);
  const between = (here, there, part) => (part === 1 ? there : here.map((value, k) => value + part * (there[k] - value)));

  // n over k, for all n up to a degree
  const over = (degree, k) => {
    const found = new Float64Array(degree + 1);
    for (let n = k, ways = 1; n <= degree; ways = (ways * ++n) / (n - k)) found[n] = ways;
    return found;
  };

  // A profile in polynomials, each about the middle of its stretch (live_data.py), and the search for where it is touched.
  class Profile {
    constructor({ low, high, closed, degree, edges, x, y }) {
      const ends = page.unpacked(edges, 0), open = (text) => page.unpacked(text, (ends.length - 1) * (degree + 1));
      Object.assign(this, { low, high, closed, degree, span: high - low, edges: ends, x: open(x), y: open(y) });
      this.unit = this.span / TURN;
      this.ways = Array.from({ length: degree + 1 }, (_, k) => over(degree, k)); // n over k
      this.found = new Float64Array(2 * (degree + 1));
      this.samples = Array.from({ length: closed ? SAMPLES : SAMPLES + 1 }, (_, k) => low + (k * this.span) / SAMPLES);
      [this.sx, this.sy] = [0, 1].map((part) => Float64Array.from(this.samples, (s) => this.at(s, 0)[part]));
    }
    wrapped(s) {
      return this.closed ? s - this.span * Math.floor((s - this.low) / this.span) : s;
    }
    // Taylor coefficients up to an order: x and y of each
    at(parameter, order) {
      const s = this.wrapped(parameter), { edges, degree, found } = this;
      let low = 0, high = edges.length - 1;
      while (high - low > 1) { const middle = (low + high) >> 1; if (edges[middle] <= s) low = middle; else high = middle; }
      const away = s - (edges[low] + edges[low + 1]) / 2, base = low * (degree + 1);
      for (let k = 0; k <= order; k++) {
        const ways = this.ways[k];
        let x = 0, y = 0;
        for (let n = degree; n >= k; n--) {
          x = x * away + ways[n] * this.x[base + n];
          y = y * away + ways[n] * this.y[base + n];
        }
        found[2 * k] = x;
        found[2 * k + 1] = y;
      }
      return found;
    }
    // the parameter of the place nearest to a point, or of that farthest in a direction: where this has its greatest
    // value among samples, then by Newton's steps between the samples beside it
    touched(ax, ay, isFlat) {
      if (ax !== ax || ay !== ay) return NaN;
      const { sx, sy, samples, closed } = this, last = samples.length - 1;
      let best = 0, most = -Infinity;
      for (let k = 0; k <= last; k++) {
        const dx = sx[k] - ax, dy = sy[k] - ay, value = isFlat ? sx[k] * ax + sy[k] * ay : -dx * dx - dy * dy;
        if (value > most) [most, best] = [value, k];
      }
      const step = this.span / SAMPLES, s = samples[best];
      let low = s - step, high = s + step;
      if (!closed) [low, high] = [Math.max(low, this.low), Math.min(high, this.high)];
      const rise = (at) => {
        const [x, y, dx, dy, bx, by] = this.at(at, 2);
        return isFlat ? [ax * dx + ay * dy, 2 * (ax * bx + ay * by)] : [(ax - x) * dx + (ay - y) * dy, 2 * ((ax - x) * bx + (ay - y) * by) - dx * dx - dy * dy];
      };
      if (low === s && rise(s)[0] <= 0) return s;
      if (high === s && rise(s)[0] >= 0) return s;
      let at = s;
      for (let round = 0; round < HALVINGS; round++) {
        const [slope, bend] = rise(at);
        if (slope > 0) low = at; else high = at;
        const next = at - slope / bend, inside = next > low && next < high ? next : (low + high) / 2;
        const far = Math.abs(inside - at);
        at = inside;
        if (far <= RESTS * this.span) break;
      }
      return closed ? this.wrapped(at) : at;
    }
  }

  class States {
    // `values` are those of the drivers at all poses, `single` a machine of one pose, `start` where everything starts
    constructor({ size, states, contacts, sides, dimensions }, program, { start, values, single }) {
      const searched = contacts.map((one) => ({ ...one, profile: new Profile(one.profile), order: Math.max(0, ...one.rows.map(([, , k]) => k)) }));
      for (const one of searched) one.meets = one.follower && new page.Follower(one.profile, one.follower, one.flat);
      Object.assign(this, { program, size, all: [...states, ...searched], sides, start, single });
      this.signs = states.flatMap(({ sign, own }, index) => (sign === undefined ? [] : [{ index, sign, own: page.unpacked(own, values[0].length) }]));
      this.special = dimensions.flatMap(({ keeps, value }, index) => (keeps === false ? [[index, value]] : []));
      this.drives = (k) => values.map((one) => one[k]);
      this.corrected = states.some(({ corrected }) => corrected);
      this.units = dimensions.map(({ kind, value }) => (kind === "angle" ? 1 : kind === "ratio" ? Math.abs(value) : size));
    }
    // brings the machine of one pose to values of the drivers, each of which has three rows
    drive(values) {
      values.forEach((value, index) => { this.single.rows[3 * index][0] = value; });
    }
    get any() {
      return this.all.length > 0;
    }
    // how far a number of a state is from another, in parts of the size or radians
    away({ angle, profile }, here, there) {
      if (profile) return profile.closed ? wrapped((here - there) / profile.unit) : (here - there) / profile.unit;
      return angle ? wrapped(here - there) : (here - there) / this.size;
    }
    unit({ angle, profile }) {
      return profile ? profile.unit : angle ? 1 : this.size;
    }

    // the states for other dimensions, with the machine left at them: those of a design nearby, corrected at all poses
    // at once. They are right where they agree with the pose at which everything starts, and go on evenly from pose to
    // pose; otherwise they are followed from there.
    carried(machine, numbers, near, home = null) {
      const values = near.values.map((row) => row.slice());
      // a change point is there as long as all that it hangs on is; else a group stays in the mode in which it was drawn
      const passes = this.special.every(([index, value]) => numbers[index] === value);
      for (const { index, sign, own } of this.signs) values[index] = passes ? own.slice() : own.map(() => sign);
      const strides = this.corrected ? this.strides(numbers, near.numbers) : 1;
      for (let step = 1; step <= strides; step++) {
        machine.take(between(near.numbers, numbers, step / strides));
        this.close(machine, values, near);
      }
      if (this.corrected && home) this.settle(numbers, values, near, home);
      this.give(machine, values);
      machine.run(0, this.program.ends[0]);
      return { numbers: Float64Array.from(numbers), values, sides: this.sides.map((place) => machine.copy(place)) };
    }
    strides(numbers, before) {
      return Math.min(STRIDES, Math.max(1, Math.ceil(this.far(numbers, before) / STRIDE)));
    }
    // the greatest change of a dimension, in parts of the size, radians, or parts of itself
    far(numbers, before) {
      return numbers.reduce((far, to, k) => Math.max(far, Math.abs(to - before[k]) / (this.units[k] || 1)), 0);
    }
    give(machine, values, k = null) {
      this.all.forEach(({ row, rows, profile, order }, index) => {
        const own = k === null ? values[index] : [values[index]];
        if (row >= 0) machine.rows[row].set(own);
        if (!profile) return;
        for (let n = 0; n < own.length; n++) {
          const found = profile.at(own[n], order);
          for (const [place, part, k] of rows) machine.rows[place][n] = found[2 * k + (part === "y" ? 1 : 0)];
        }
      });
    }
    // searches a contact at all poses of a machine; tells of each by how much it has moved
    search(machine, contact, values, index, moved) {
      const { aim: [x, y], profile, flat, meets } = contact, own = values[index];
      if (meets) return this.meet(machine, contact, values, index, moved);
      const [ax, ay] = [machine.row(x, 0), machine.row(y, 1)];
      for (let k = 0; k < own.length; k++) {
        const found = profile.touched(ax[k], ay[k], flat);
        if (found !== found) continue;
        moved(k, Math.abs(this.away({ profile }, found, own[k])));
        own[k] = found;
      }
    }
    // the same where a follower comes to its profile, with its coordinate
    meet(machine, contact, values, index, moved) {
      const { follower: { state, path }, meets } = contact, each = this.all[state];
      for (let k = 0; k < values[index].length; k++) {
        const [q, s] = meets.met(path.map((place) => (place >= 0 ? machine.rows[place][k] : machine.numbers[-1 - place])), machine, k);
        if (q === q) moved(k, Math.max(Math.abs(this.away(each, q, values[state][k])), Math.abs(this.away(contact, s, values[index][k]))));
        values[state][k] = q;
        values[index][k] = s;
      }
    }

    // corrects states until they stay; those that do not are left as they were
    close(machine, values, near) {
      const before = values.map((row) => row.slice());
      this.lost = new Uint8Array(machine.length);
      for (let round = 0; round < ROUNDS; round++) {
        this.give(machine, values);
        machine.run(0, this.program.ends[0]);
        let open = false;
        this.open = new Uint8Array(machine.length);
        this.all.forEach((state, index) => {
          const own = values[index];
          if (state.searched) return; // with its contact
          if (state.profile) return this.search(machine, state, values, index, (k, far) => { if (!(far <= FOUND)) this.open[k] = 1; });
          const now = machine.row(state.now, 0);
          if (!state.corrected) open = this.counted(now, own, near.values[index]) || open;
          else {
            for (let k = 0; k < own.length; k++) {
              const step = Math.abs(this.away(state, now[k], own[k]));
              if (!(step <= CLOSED)) this.open[k] = 1;
              own[k] = now[k];
            }
          }
        });
        if (!open && !this.open.includes(1)) break;
        if (!open && round > 3 && this.settled(values)) break;
      }
      const sides = this.sides.map((place) => machine.row(place, 0));
      for (let k = 0; k < this.lost.length; k++) {
        const leaps = this.all.some((state, index) => state.corrected && !(Math.abs(this.away(state, values[index][k], before[index][k])) <= LEAP));
        const passes = near.sides && sides.some((side, index) => side[k] * near.sides[index][k] < 0);
        if (!this.open[k] && !leaps && !passes) continue;
        this.lost[k] = this.corrected ? 1 : 0;
        this.all.forEach((state, index) => { if (state.corrected || (state.profile && !state.meets)) values[index][k] = before[index][k]; });
      }
    }
    // whether what is still open is no number any more
    settled(values) {
      return this.all.every((state, index) => !state.corrected || values[index].every((value, k) => !this.open[k] || value !== value));
    }
    // counts turns along the motion as they were counted in the design before; tells whether any changed by one
    counted(now, own, near) {
      let before = -1, changed = false;
      for (let k = 0; k < now.length; k++) {
        if (now[k] !== now[k]) continue;
        const about = before < 0 ? near[k] : own[before] + (near[k] - near[before]);
        const angle = about === about ? now[k] + TURN * Math.round((about - now[k]) / TURN) : now[k];
        changed ||= !(Math.abs(angle - own[k]) < Math.PI);
        own[k] = angle;
        before = k;
      }
      return changed;
    }

    // follows the states from the pose where everything starts, unless they are right as they are
    settle(numbers, values, near, home) {
      const at = (rows, k) => rows.map((row) => row[k]);
      const k = this.start;
      this.drive(this.drives(k));
      const begin = this.led(at(home.values, k), home, numbers) || this.led(at(near.values, k), near, numbers);
      if (!begin) return;
      const agrees = !this.lost[k] && this.apart(begin, at(values, k)) < CLOSED * 10;
      this.single.take(numbers);
      if (!agrees || !this.isEven(values, near, UNEVEN + this.far(numbers, near.numbers))) {
        for (const way of [1, -1]) this.march(k, way, begin, values);
        return;
      }
      // what was lost may be reached from the poses beside it
      const lost = this.lost;
      for (const way of [1, -1]) {
        for (let n = 1, end = -1; n < lost.length; n++) {
          const from = way > 0 ? n - 1 : lost.length - n;
          if (from !== end && !lost[from] && lost[from + way]) end = this.march(from, way, at(values, from), values, lost);
        }
      }
    }
    // the state of the start as dimensions go from those of a design to others, in steps as long as it stays near
    led(state, design, numbers) {
      if (state.some((value, k) => value !== value && this.all[k].corrected)) return null;
      return this.follow(state, null, (part) => this.single.take(between(design.numbers, numbers, part)))?.state;
    }
    // from pose to pose, through those `only` that are lost; tells where it ended
    march(k, way, begin, values, only = null) {
      let found = { state: begin, slope: null };
      for (let n = k + way; n >= 0 && n < values[0].length && (!only || only[n]); n += way) {
        const from = this.drives(n - way), to = this.drives(n);
        found = this.follow(found.state, found.slope, (part) => this.drive(from.map((one, index) => one + part * (to[index] - one))));
        if (!found) return n - way;
        found.state.forEach((value, index) => { values[index][n] = value; });
        if (only) only[n] = 0;
      }
      return -1;
    }
    // follows a state from one place to another; `go` brings the machine to a part of the way
    follow(state, slope, go) {
      const one = this.single;
      let t = 0, h = 1, side = null;
      while (t < 1) {
        go(Math.min(1, t + h));
        const guess = state.map((value, index) => (slope ? value + h * slope[index] : value));
        const led = guess.slice();
        const closes = this.newton(one, guess) && this.apart(guess, led) <= STRAY;
        const sides = closes ? this.sides.map((place) => one.row(place, 0)[0]) : null;
        if (closes && !(side && sides.some((now, index) => now * side[index] < 0))) {
          slope = this.all.map((each, index) => (this.away(each, guess[index], state[index]) * this.unit(each)) / h);
          [state, side] = [guess, sides];
          t += h;
          h = Math.min(2 * h, 1 - t);
        } else if ((h /= 2) < SHORTEST) return null;
      }
      return { state, slope };
    }
    apart(here, there) {
      return Math.max(...this.all.map((each, index) => (each.corrected ? Math.abs(this.away(each, here[index], there[index])) : 0)));
    }
    // whether states go on from pose to pose as they did in another design
    isEven(values, near, most) {
      return this.all.every((each, index) => {
        const own = values[index], other = near.values[index];
        if (each.corrected) {
          for (let k = 1; k < own.length; k++) {
            if (this.lost[k] || this.lost[k - 1]) continue;
            if (Math.abs(this.away(each, own[k], own[k - 1]) - this.away(each, other[k], other[k - 1])) > most) return false;
          }
        }
        return true;
      });
    }
    // corrects the state of one pose; tells whether it closes
    newton(one, guess) {
      for (let round = 0; round < ROUNDS; round++) {
        this.give(one, guess, 0);
        one.run(0, this.program.ends[0]);
        let far = 0;
        this.all.forEach((state, index) => {
          if (state.searched) return;
          if (state.profile) {
            const own = guess.map((value) => [value]);
            this.search(one, state, own, index, (_, off) => { if (!(off <= FOUND)) far = Math.max(far, CLOSED * 2); });
            own.forEach(([value], n) => { guess[n] = value; });
            return;
          }
          const now = one.row(state.now, 0)[0];
          if (state.corrected) far = Math.max(far, Math.abs(this.away(state, now, guess[index])) || (now === now ? 0 : Infinity));
          guess[index] = state.corrected ? now : guess[index] + wrapped(now - guess[index]);
        });
        if (far <= CLOSED) return true;
        if (far === Infinity) return false;
      }
      return false;
    }
  }

  Object.assign(page, { States, Profile });
})();
