// The path: all poses of all links as a function of the dimensions, by the mechanism's own program.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const TURN = 2 * Math.PI;

  // makes an angle continuous along the motion, over gaps too
  const unwrap = (angle) => {
    let before = NaN, turns = 0;
    for (let k = 0; k < angle.length; k++) {
      if (angle[k] !== angle[k]) continue;
      const here = angle[k];
      if (before === before) turns -= Math.round((here - before) / TURN);
      before = here;
      angle[k] = here + TURN * turns;
    }
    return angle;
  };

  // all poses of one design; made once and never changed
  class Solved {
    constructor(fields) {
      Object.assign(this, fields);
    }
  }

  // a number as Python writes it with six digits
  const six = (value) => {
    const [digits, exponent] = value.toExponential(5).split("e").map(Number);
    if (exponent >= -4 && exponent < 6) return String(Number(value.toPrecision(6)));
    return `${digits}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
  };

  class Path {
    constructor(data) {
      const { live } = data;
      this.data = live;
      this.poses = data.poses;
      this.start = data.start;
      this.program = { ...live.program, before: page.wholes(live.program.before), along: page.wholes(live.program.along) };
      this.names = live.dimensions.map(({ name }) => name);
      this.own = Float64Array.from(live.dimensions, ({ value }) => value);
      this.drives = live.drives.map((one) => [one.value, ...one.rates].map((text) => page.unpacked(text, data.poses)));
      this.whole = new page.Machine(this.program, data.poses);
      this.one = new page.Machine(this.program, 1);
      this.drives.flat().forEach((values, k) => this.whole.rows[k].set(values));
      // what loads need that one pose does not know, given at the poses
      this.firstGiven = 3 * this.drives.length + live.seeds;
      this.given = (live.forces?.rows ?? []).map((text) => page.unpacked(text, data.poses));
      this.given.forEach((values, k) => this.whole.rows[this.firstGiven + k].set(values));
      // quantities of forces come last of all
      this.outputs = [...live.program.outputs, ...(live.forces?.outputs ?? [])];
      this.last = this.program.ends[live.forces ? 4 : 2];
      this.states = new page.States(live, this.program, { start: this.start, values: this.drives.map(([values]) => values), single: this.one });
      this.home = { numbers: this.own, values: this.states.all.map(({ own }) => page.unpacked(own, data.poses)), sides: null };
    }
    driven(machine, drives) {
      drives.forEach((values, index) => values.forEach((value, order) => { machine.rows[3 * index + order][0] = value; }));
    }

    // the motion for dimensions; `near` is that of dimensions nearby. Without rates only positions are computed.
    solved(numbers, near = null, { rates = true } = {}) {
      const machine = this.whole, { outputs, last } = this, { links, ends } = this.program;
      const states = this.states.any ? this.states.carried(machine, numbers, this.near(near), this.home) : null;
      if (!states) machine.take(numbers);
      machine.run(states ? ends[0] : 0, rates ? last : ends[1]);
      const { failed, assembled } = this.closed(machine);
      const known = (place) => {
        const found = machine.copy(place);
        for (let k = 0; k < found.length; k++) if (failed[k]) found[k] = NaN;
        return found;
      };
      const moved = ({ at, wrapped }) => {
        const [x, y, angle] = at[0].map(known);
        const [v, a] = [1, 2].map((order) => (rates && at[order] ? at[order].map(known) : null));
        return { x, y, angle: wrapped ? unwrap(angle) : angle, v, a };
      };
      const told = rates ? Object.fromEntries(outputs.map((one) => [one.name, this.output(one, known)])) : null;
      return new Solved({ numbers: Float64Array.from(numbers), assembled, failed, links: links.map(moved), outputs: told, states });
    }
    // what acts on links at all poses of a design: place, force and moment of each arrow and arc
    acting({ numbers, states, failed }) {
      const machine = this.whole, { arrows, arcs } = this.data.forces;
      machine.take(numbers);
      if (states) this.states.give(machine, states.values);
      machine.run(0, this.program.ends[4]);
      const known = (place) => {
        const found = machine.copy(place);
        for (let k = 0; k < found.length; k++) if (failed[k]) found[k] = NaN;
        return found;
      };
      const of = (places) => { const [x, y, fx, fy, moment] = places.map(known); return { at: [x, y], force: [fx, fy], moment }; };
      return { arrows: arrows.map(of), arcs: arcs.map(of) };
    }
    // the states to begin with: of a design nearby, or of the mechanism as it was
    near(solved) {
      if (this.home.sides === null) this.home = this.states.carried(this.whole, this.own, this.home);
      return (solved && solved.states) || this.home;
    }

    // which group fails at each pose: the first that does not close
    closed(machine) {
      const failed = new Uint8Array(machine.length), assembled = new Float64Array(machine.length).fill(1);
      for (const [index, place] of this.program.goods) {
        const good = machine.row(place, 0);
        for (let k = 0; k < failed.length; k++) if (!failed[k] && good[k] !== 1) failed[k] = index + 1;
      }
      for (let k = 0; k < failed.length; k++) if (failed[k]) assembled[k] = 0;
      return { failed, assembled };
    }

    // an output, lengths and radians; angles whose turns nobody counts are made continuous
    output({ parts, wrapped }, known) {
      const told = (place) => {
        const values = known(place);
        // half a turn back is half a turn on
        if (wrapped) for (let k = 0; k < values.length; k++) if (values[k] === -Math.PI) values[k] = Math.PI;
        return wrapped ? unwrap(values) : values;
      };
      return Object.fromEntries(Object.entries(parts).map(([part, place]) => [part, told(place)]));
    }

    // brings the machine of one pose to it, for some of the program's sections; `place` is between the poses
    posed(numbers, drives, near, k, section, place = k) {
      const machine = this.one;
      const states = this.states.any ? this.near(near).values.map((row) => row[k]) : null;
      machine.take(numbers);
      this.driven(machine, drives);
      if (states) {
        this.states.newton(machine, states);
        this.states.give(machine, states, 0);
      }
      const low = Math.min(Math.floor(place), this.poses - 2), part = place - low;
      this.given.forEach((row, index) => { machine.rows[this.firstGiven + index][0] = part ? row[low] + part * (row[low + 1] - row[low]) : row[low]; });
      machine.run(0, this.program.ends[section]);
      return machine;
    }
    // one pose: drives are [value, rate, second] of each driver, `k` is the pose nearest to the place
    at(numbers, drives, near = null, k = this.start, place = k) {
      const machine = this.posed(numbers, drives, near, k, this.data.forces ? 4 : 2, place), { outputs } = this, { links } = this.program;
      const { failed } = this.closed(machine);
      const known = (place) => (failed[0] ? NaN : machine.row(place, 0)[0]);
      const moved = ({ at }) => {
        const [x, y, angle] = at[0].map(known);
        const [v, a] = [1, 2].map((order) => at[order] ? at[order].map(known) : null);
        return { x, y, angle, v, a };
      };
      const told = ({ name, parts }) => [name, Object.fromEntries(Object.entries(parts).map(([part, place]) => [part, known(place)]))];
      return { assembled: !failed[0], failed: failed[0], links: links.map(moved), outputs: Object.fromEntries(outputs.map(told)) };
    }

    // what is known of a pose that is not assembled: the links before the group that fails, null for the others; `names` are theirs
    partial(numbers, solved, k, names) {
      const machine = this.posed(numbers, this.drives.map((values) => values.map((value) => value[k])), solved, k, 1);
      const index = solved.failed[k] - 1, lost = new Set(this.data.groups.slice(index).flatMap(({ guide, links }) => (guide ? [] : links)));
      return this.program.links.map(({ at }, link) => {
        const [x, y, angle] = at[0].map((place) => machine.row(place, 0)[0]);
        return lost.has(names[link]) || !Number.isFinite(x + y + angle) ? null : { x: [x], y: [y], angle: [angle] };
      });
    }

    // why a pose is not assembled: which group, or which guide with ends, and the words of Python's gaps; "" where it is
    why(numbers, solved, k) {
      const group = this.data.groups[solved.failed[k] - 1];
      if (!group) return "";
      const machine = this.posed(numbers, this.drives.map((values) => values.map((value) => value[k])), solved, k, 3);
      const value = (place) => machine.row(place, 0)[0];
      const reason = group.reasons.find(({ holds }) => holds === null || value(holds) === 1);
      const text = reason ? reason.words.map((word) => (typeof word === "string" ? word : six(value(word)))).join("") : "";
      return { group: group.guide ? group.name : `${group.name}(${group.links.join(", ")})`, text };
    }
  }

  Object.assign(page, { Path, Solved });
})();
