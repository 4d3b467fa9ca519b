// The range of one number in which the mechanism assembles, found while the browser has nothing else to do.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const FIRST = 0.5, GROWTH = 1.5; // of a step of the field: how far it looks first, and by how much farther each time
  const MOST = 20; // sizes: what assembles so far out does so for ever
  const FINE = 1e-5; // of the size: how sure an end is
  const SLICE = 8; // milliseconds at a time, so that keys and pointers are heard

  // The values of a row around the one that it has. Poses that are not assembled now need not be then.
  class AssembledRange {
    // `done` is given {low, high}, either null where there is no end
    constructor(design, row, done) {
      Object.assign(this, { design, row, done, stopped: false });
      this.size = row.isAngle ? 360 : row.panel.size;
      this.near = design.solved;
      this.numbers = design.numbers;
      this.needed = [...this.near.assembled.keys()].filter((k) => this.near.assembled[k] === 1);
      this.work = this.needed.length ? this.search() : [][Symbol.iterator]();
      this.next();
    }
    stop() { this.stopped = true; }
    next() {
      setTimeout(() => {
        const until = performance.now() + SLICE;
        while (!this.stopped && performance.now() < until) {
          const { done, value } = this.work.next();
          if (done) {
            if (value) this.done(value);
            return;
          }
        }
        if (!this.stopped) this.next();
      });
    }
    *search() {
      const here = this.row.get(this.of), reach = this.row.isAngle ? 180 : MOST * this.size;
      const low = yield* this.end(here, this.row.positive ? FINE * this.size : here - reach, -1);
      const high = yield* this.end(here, here + reach, 1);
      return { low, high };
    }
    get of() { return (name) => this.numbers[this.design.index.get(name)]; }
    // the last value on the way to `bound` that assembles; null where all do
    *end(here, bound, way) {
      let good = here, step = FIRST * this.row.step;
      while (way * (bound - good) > 0) {
        const to = way * (bound - good) <= step ? bound : good + way * step;
        const assembles = this.assembles(to);
        yield;
        if (!assembles) return yield* this.between(good, to);
        good = to;
        step *= GROWTH;
      }
      return null;
    }
    *between(good, bad) {
      while (Math.abs(bad - good) > FINE * this.size) {
        const middle = (good + bad) / 2;
        if (this.assembles(middle)) good = middle;
        else bad = middle;
        yield;
      }
      return good;
    }
    assembles(value) {
      const numbers = Float64Array.from(this.numbers), found = this.row.set(value, this.of);
      for (const name in found) numbers[this.design.index.get(name)] = found[name];
      const { assembled } = this.design.path.solved(numbers, this.near, { rates: false });
      return this.needed.every((k) => assembled[k] === 1);
    }
  }

  // told with so many digits as are sure, inward, so that what is told does assemble
  const told = (row, { low, high }) => {
    const fine = page.round(20 * FINE * (row.isAngle ? 360 : row.panel.size));
    const inward = (value, way) => page.written(Number((way(value / fine) * fine).toPrecision(12)));
    const at = [low === null ? null : inward(low, Math.ceil), high === null ? null : inward(high, Math.floor)];
    const unit = row.unit === "°" ? "°" : row.unit && ` ${row.unit}`;
    if (low === null && high === null) return "at any value";
    if (low === null) return `up to ${at[1]}${unit}`;
    if (high === null) return `from ${at[0]}${unit}`;
    return `from ${at[0]} to ${at[1]}${unit}`;
  };

  Object.assign(page, { AssembledRange, rangeTold: told });
})();
