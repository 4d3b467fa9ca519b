// The states: what a program is given besides dimensions and drivers, carried from design to design and pose to pose.
// They are positions of groups without a closed form, which Newton's steps correct, and angles with their full turns.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const TURN = 2 * Math.PI;
  const STRIDE = 0.05, STRIDES = 64; // how far a dimension goes in one step (parts of the size, or radians), and how often
  const ROUNDS = 10; // Newton's steps, of which three are the rule
  const CLOSED = 1e-9; // the step after such a one reaches rounding
  const LEAP = 0.5; // what moves farther (parts of the size, radians) has left its configuration

  const wrapped = (angle) => angle - TURN * Math.round(angle / TURN);

  class States {
    constructor(live, program) {
      Object.assign(this, { program, size: live.size, all: live.states, sides: live.sides });
      this.corrected = this.all.some(({ corrected }) => corrected);
    }
    get any() {
      return this.all.length > 0;
    }
    // how far a number of a state is from another, in parts of the size or radians
    away({ angle }, here, there) {
      return angle ? wrapped(here - there) : (here - there) / this.size;
    }

    // brings the states of a design nearby to other dimensions, all poses at once, and leaves the machine with them
    carried(machine, numbers, near) {
      const values = near.values.map((row) => row.slice());
      const strides = this.corrected ? this.strides(numbers, near.numbers) : 1;
      for (let step = 1; step <= strides; step++) {
        const part = step / strides;
        machine.take(numbers.map((to, k) => (part === 1 ? to : near.numbers[k] + part * (to - near.numbers[k]))));
        this.close(machine, values, near);
      }
      if (this.corrected) this.march(machine, numbers, values, near);
      this.give(machine, values);
      machine.run(0, this.program.ends[0]);
      return { numbers: Float64Array.from(numbers), values, sides: this.sides.map((place) => machine.copy(place)) };
    }
    strides(numbers, before) {
      let far = 0;
      numbers.forEach((to, k) => { far = Math.max(far, Math.abs(to - before[k]) / (this.units[k] || 1)); });
      return Math.min(STRIDES, Math.max(1, Math.ceil(far / STRIDE)));
    }
    give(machine, values, k = null) {
      this.all.forEach(({ row }, index) => {
        if (k === null) machine.rows[row].set(values[index]);
        else machine.rows[row][0] = values[index];
      });
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
          const now = machine.row(state.now, 0), own = values[index];
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
        this.all.forEach((state, index) => { if (state.corrected) values[index][k] = before[index][k]; });
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

    // what was lost is looked for from the poses beside it, both ways along the motion
    march(machine, numbers, values, near) {
      if (!this.lost.includes(1) || !this.lost.includes(0)) return;
      this.single.take(numbers);
      const found = this.lost.map((lost) => 1 - lost);
      for (const way of [1, -1]) {
        for (let n = 1; n < found.length; n++) {
          const k = way > 0 ? n : found.length - 1 - n;
          if (!found[k] && found[k - way] && this.reached(k, way, found, values, near)) found[k] = 1;
        }
      }
    }
    // one pose from that beside it, as the two before it lead on
    reached(k, way, found, values) {
      const one = this.single, from = k - way;
      const leads = from - way >= 0 && from - way < found.length && found[from - way];
      const guess = this.all.map((state, index) => {
        const last = values[index][from];
        return leads ? last + this.away(state, last, values[index][from - way]) * (state.angle ? 1 : this.size) : last;
      });
      const start = guess.slice();
      this.driven(one, k);
      if (!this.newton(one, guess)) return false;
      if (this.all.some((state, index) => state.corrected && !(Math.abs(this.away(state, guess[index], start[index])) <= LEAP / 5))) return false;
      guess.forEach((value, index) => { values[index][k] = value; });
      return true;
    }
    // corrects the state of one pose; tells whether it closes
    newton(one, guess) {
      for (let round = 0; round < ROUNDS; round++) {
        this.give(one, guess, 0);
        one.run(0, this.program.ends[0]);
        let far = 0;
        this.all.forEach((state, index) => {
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

  Object.assign(page, { States });
})();
