// The path: all poses of all links as a function of the dimensions, by the mechanism's own program.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const TURN = 2 * Math.PI;

  // numbers as markup.py packs them, one for all poses or one for each
  const unpacked = (text, count) => {
    if (text === null) return new Float64Array(count).fill(NaN);
    if (typeof text === "number") return new Float64Array(count).fill(text);
    return new Float64Array(Uint8Array.from(atob(text.slice(2)), (c) => c.charCodeAt(0)).buffer);
  };
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

  class Path {
    constructor(data) {
      const { live } = data;
      this.data = live;
      this.poses = data.poses;
      this.start = data.start;
      this.program = { ...live.program, before: page.wholes(live.program.before), along: page.wholes(live.program.along) };
      this.names = live.dimensions.map(({ name }) => name);
      this.own = Float64Array.from(live.dimensions, ({ value }) => value);
      this.drives = live.drives.map((one) => [one.value, ...one.rates].map((text) => unpacked(text, data.poses)));
      this.whole = new page.Machine(this.program, data.poses);
      this.drives.flat().forEach((values, k) => this.whole.rows[k].set(values));
    }

    // the motion for dimensions; `near` is that of dimensions nearby. Without rates only positions are computed.
    solved(numbers, near = null, { rates = true } = {}) {
      const machine = this.whole, { links, outputs, positions } = this.program;
      machine.take(numbers);
      machine.run(0, rates ? machine.count : positions);
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
      return new Solved({ numbers: Float64Array.from(numbers), assembled, failed, links: links.map(moved), outputs: told });
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

    // one pose: drives are [value, rate, second] of each driver, `k` is the pose nearest
    at(numbers, drives, near = null, k = this.start) {
      this.one ||= new page.Machine(this.program, 1);
      const machine = this.one, { links, outputs } = this.program;
      machine.take(numbers);
      drives.forEach((values, index) => values.forEach((value, order) => { machine.rows[3 * index + order][0] = value; }));
      machine.run(0, machine.count);
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

    // why a pose is not assembled: the group, and words for it; "" where it is
    why(numbers, solved, k) {
      const group = this.data.groups[solved.failed[k] - 1];
      return group ? { group: `${group.name}(${group.links.join(", ")})`, text: "cannot be assembled" } : "";
    }
  }

  Object.assign(page, { Path, Solved });
})();
