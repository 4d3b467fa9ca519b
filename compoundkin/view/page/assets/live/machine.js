// The machine: computes a table of operations, each over one row of numbers, one for each pose.
// Loops over rows are quick from the first call on, and no program is too long for the browser to optimise.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const WIDTH = 5; // entries of an operation: which, where to, three operands

  // ties go to the even number, as everywhere else
  const rint = (a) => (Math.abs(a % 1) === 0.5 ? 2 * Math.round(a / 2) : Math.round(a));
  // operations on single numbers; what is no number stays none in max and min, and is passed over in fmax and fmin
  const SINGLE = {
    add: (a, b) => a + b,
    sub: (a, b) => a - b,
    mul: (a, b) => a * b,
    neg: (a) => -a,
    inv: (a) => 1 / a,
    sqrt: Math.sqrt, abs: Math.abs, sin: Math.sin, cos: Math.cos, atan2: Math.atan2,
    exp: Math.exp, log: Math.log, max: (a, b) => Math.max(a, b), min: (a, b) => Math.min(a, b), floor: Math.floor, ceil: Math.ceil, rint,
    fmax: (a, b) => (a >= b || b !== b ? a : b),
    fmin: (a, b) => (a <= b || b !== b ? a : b),
    ge: (a, b) => (a >= b ? 1 : 0),
    gt: (a, b) => (a > b ? 1 : 0),
    eq: (a, b) => (a === b ? 1 : 0),
    and: (a, b) => (a !== 0 && b !== 0 ? 1 : 0),
    or: (a, b) => (a !== 0 || b !== 0 ? 1 : 0),
    not: (a) => (a === 0 ? 1 : 0),
    select: (truth, one, other) => (truth !== 0 ? one : other),
  };
  // the same over rows; each loop is a function of its own, so that a browser makes the best of it
  const ROWS = {
    add: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] + b[k]; },
    sub: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] - b[k]; },
    mul: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] * b[k]; },
    neg: (n, o, a) => { for (let k = 0; k < n; k++) o[k] = -a[k]; },
    inv: (n, o, a) => { for (let k = 0; k < n; k++) o[k] = 1 / a[k]; },
    sqrt: (n, o, a) => { for (let k = 0; k < n; k++) o[k] = Math.sqrt(a[k]); },
    abs: (n, o, a) => { for (let k = 0; k < n; k++) o[k] = Math.abs(a[k]); },
    sin: (n, o, a) => { for (let k = 0; k < n; k++) o[k] = Math.sin(a[k]); },
    cos: (n, o, a) => { for (let k = 0; k < n; k++) o[k] = Math.cos(a[k]); },
    atan2: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = Math.atan2(a[k], b[k]); },
    max: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = Math.max(a[k], b[k]); },
    min: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = Math.min(a[k], b[k]); },
    ge: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] >= b[k] ? 1 : 0; },
    gt: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] > b[k] ? 1 : 0; },
    and: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] !== 0 && b[k] !== 0 ? 1 : 0; },
    select: (n, o, t, a, b) => { for (let k = 0; k < n; k++) o[k] = t[k] !== 0 ? a[k] : b[k]; },
  };
  // a number with a row, the commonest mixtures
  const WITH_NUMBER = {
    add: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] + b; },
    mul: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] * b; },
    sub: (n, o, a, b) => { for (let k = 0; k < n; k++) o[k] = a[k] - b; },
  };
  const REVERSED = {
    add: WITH_NUMBER.add,
    mul: WITH_NUMBER.mul,
    sub: (n, o, b, a) => { for (let k = 0; k < n; k++) o[k] = a - b[k]; },
  };

  // whole numbers as table_data.py packs them
  const wholes = (text) => {
    const bytes = Uint8Array.from(atob(text.slice(2)), (c) => c.charCodeAt(0));
    return Int32Array.from(text[0] === "h" ? new Int16Array(bytes.buffer) : new Int32Array(bytes.buffer));
  };

  class Machine {
    // `length` is that of rows
    constructor(program, length) {
      Object.assign(this, { program, length });
      this.before = program.before instanceof Int32Array ? program.before : wholes(program.before);
      this.along = program.along instanceof Int32Array ? program.along : wholes(program.along);
      this.numbers = new Float64Array(program.numbers);
      this.numbers.set(program.constants.map(Number)); // what JSON has no number for is a text
      this.rows = Array.from({ length: program.rows }, () => new Float64Array(length));
      this.spare = [0, 1, 2].map(() => new Float64Array(length));
      this.single = program.codes.map((name) => SINGLE[name]);
      this.whole = program.codes.map((name) => ROWS[name] || over(length, SINGLE[name]));
      this.mixed = program.codes.map((name) => WITH_NUMBER[name]);
      this.reversed = program.codes.map((name) => REVERSED[name]);
    }

    // takes the dimensions, and computes what they alone determine
    take(dimensions) {
      const { numbers, before, single } = this;
      numbers.set(dimensions, this.program.constants.length);
      for (let k = 0; k < before.length; k += WIDTH) {
        const value = (place) => numbers[-1 - place];
        numbers[-1 - before[k + 1]] = single[before[k]](value(before[k + 2]), value(before[k + 3]), value(before[k + 4]));
      }
    }

    // computes operations along the poses, from one up to one
    run(from, upto) {
      const { along, rows, numbers, length, whole, mixed, reversed } = this;
      for (let k = from * WIDTH; k < upto * WIDTH; k += WIDTH) {
        const code = along[k], out = rows[along[k + 1]], a = along[k + 2], b = along[k + 3];
        if (a >= 0 && b < 0 && mixed[code]) mixed[code](length, out, rows[a], numbers[-1 - b]);
        else if (a < 0 && b >= 0 && reversed[code]) reversed[code](length, out, rows[b], numbers[-1 - a]);
        else whole[code](length, out, this.row(a, 0), this.row(b, 1), this.row(along[k + 4], 2));
      }
    }
    get count() {
      return this.along.length / WIDTH;
    }

    // what is at a place, as a row; of a number one that is filled with it
    row(place, spare) {
      return place >= 0 ? this.rows[place] : this.spare[spare].fill(this.numbers[-1 - place]);
    }
    // a copy that stays
    copy(place) {
      return place >= 0 ? this.rows[place].slice() : new Float64Array(this.length).fill(this.numbers[-1 - place]);
    }
  }

  const over = (length, single) => (n, o, a, b, c) => { for (let k = 0; k < n; k++) o[k] = single(a[k], b[k], c[k]); };

  Object.assign(page, { Machine, wholes });
})();
