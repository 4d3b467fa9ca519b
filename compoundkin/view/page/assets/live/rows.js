// The rows of the panel of dimensions: what each shows of the numbers of a design, and which numbers it changes.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const DEGREE = Math.PI / 180;
  const LARGEST = 1000; // sizes of the mechanism: a longer length is a slip
  const SAME = 1e-11; // of the size: coordinates nearer to the original ones are those, so that going back goes all the way
  const KINDS = { length: "length", angle: "angle", turn: "direction", x: "x of", y: "y of" };

  // the largest coordinate, to which lengths are large or small
  const sizeOf = (dimensions) => {
    const lengths = dimensions.filter(({ kind }) => kind === "point" || kind === "length").map(({ value }) => Math.abs(value));
    return Math.max(0, ...lengths) || 1;
  };
  // 1, 2 or 5 times a power of ten, at most
  const round = (most) => {
    const power = 10 ** Math.floor(Math.log10(most));
    return power * [5, 2, 1].find((by) => by * power <= most * (1 + 1e-9));
  };
  // an angle in degrees, half a turn either way
  const turned = (angle) => {
    const found = angle / DEGREE - 360 * Math.round(angle / DEGREE / 360);
    return found <= -180 ? found + 360 : found;
  };
  // a number that somebody wrote, perhaps with a comma and with its unit; NaN for what is none
  const read = (text, unit) => {
    const plain = text.trim().replace(/\u2212/g, "-").replace(",", ".");
    const found = /^([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(.*)$/i.exec(plain);
    if (!found || !["", unit, ...(unit === "°" ? ["deg"] : [])].includes(found[2])) return NaN;
    return Number(found[1]);
  };

  // What all rows share. `of` tells the number of a name: that of a design, or of the original.
  class Row {
    constructor(panel, owner) {
      Object.assign(this, { panel, owner, late: false, doc: "", positive: false, isAngle: false });
    }
    get unit() { return this.isAngle ? "°" : page.raised(this.panel.unit); }
    get step() { return this.isAngle ? 1 : round(this.panel.size / 50); }
    get most() { return this.isAngle ? 360 : LARGEST * this.panel.size; }
    // what is wrong with a value, in one sentence; "" where nothing is
    wrong(text) {
      if (!text.trim()) return "Write a number.";
      const value = read(text, this.unit);
      if (!Number.isFinite(value)) return `“${text.trim().slice(0, 20)}” is not a number.`;
      if (this.positive && value <= 0) return "It must be greater than 0.";
      if (Math.abs(value) > this.most) return `It must be at most ${page.withUnit(this.most, this.isAngle ? "deg" : this.panel.unit)}.`;
      return "";
    }
    value(text) { return read(text, this.unit); }
    isSame(one, other) { return Math.abs(one - other) <= 1e-9 * (this.isAngle ? 1 : this.panel.size); }
    // numbers by name as a design takes them; those that are the original ones but for rounding are these
    changes(found) {
      for (const name in found) {
        const own = this.panel.own(name);
        if (Math.abs(found[name] - own) <= SAME * this.panel.size) found[name] = own;
      }
      return found;
    }
  }

  // A length, angle, direction or coordinate of points of a link, in the link's own frame.
  class PointRow extends Row {
    constructor(panel, owner, [kind, letters, late]) {
      super(panel, owner);
      Object.assign(this, { kind, letters, late, moved: letters[letters.length - 1] });
      this.isAngle = kind === "angle" || kind === "turn";
      this.positive = kind === "length";
    }
    get label() {
      const [a, b, c] = this.letters, gap = this.letters.some((letter) => letter.length > 1) ? "\u2009" : "";
      if (this.kind === "length") return `|${a}${gap}${b}|`;
      if (this.kind === "angle") return `∠${b}${gap}${a}${gap}${c}`;
      return this.kind === "turn" ? `∠${a}${gap}${b}` : `${this.kind} of ${a}`;
    }
    get spoken() {
      const [a, b, c] = this.letters;
      if (this.kind === "length") return `length from ${a} to ${b}`;
      if (this.kind === "angle") return `angle at ${a} from ${b} to ${c}`;
      return this.kind === "turn" ? `direction from ${a} to ${b} in the link` : `${KINDS[this.kind]} ${a}`;
    }
    get(of) {
      const [o, p, q] = this.letters.map((letter) => this.at(letter, of));
      if (this.kind === "x") return o[0];
      if (this.kind === "y") return o[1];
      const way = [p[0] - o[0], p[1] - o[1]];
      if (this.kind === "length") return Math.hypot(...way);
      const base = Math.atan2(way[1], way[0]);
      return turned(this.kind === "turn" ? base : Math.atan2(q[1] - o[1], q[0] - o[0]) - base);
    }
    set(value, of) {
      if (this.kind === "x" || this.kind === "y") return this.changes({ [`${this.owner}.${this.moved}.${this.kind}`]: value });
      const [o, p] = this.letters.map((letter) => this.at(letter, of)), end = this.at(this.moved, of);
      if (this.kind === "length") return this.places(o, this.along(o, end), value);
      const base = this.kind === "angle" ? Math.atan2(p[1] - o[1], p[0] - o[0]) : 0;
      const angle = base + value * DEGREE;
      return this.places(o, [Math.cos(angle), Math.sin(angle)], Math.hypot(end[0] - o[0], end[1] - o[1]));
    }
    places(o, [c, s], length) {
      const base = `${this.owner}.${this.moved}`;
      return this.changes({ [`${base}.x`]: o[0] + length * c, [`${base}.y`]: o[1] + length * s });
    }
    // the direction in which a point is moved; that of the original where it lies on the other one
    along(o, end) {
      const way = [end[0] - o[0], end[1] - o[1]], length = Math.hypot(...way);
      if (length) return way.map((part) => part / length);
      const own = this.letters.map((letter) => this.at(letter, this.panel.own));
      const before = [own[1][0] - own[0][0], own[1][1] - own[0][1]];
      return before.map((part) => part / Math.hypot(...before));
    }
    at(letter, of) {
      const fixed = (this.panel.fixed[this.owner] || {})[letter];
      return ["x", "y"].map((axis, k) => of(`${this.owner}.${letter}.${axis}`) ?? fixed[k]);
    }
  }

  // A number that a pair states: an offset, an angle, a radius.
  class NumberRow extends Row {
    constructor(panel, owner, { name, told, doc, unit, size }) {
      super(panel, owner);
      Object.assign(this, { name, label: told, spoken: told, doc, given: unit, positive: size, isAngle: unit === "rad" });
    }
    get unit() { return this.isAngle ? "°" : page.raised(this.given); }
    get(of) { return this.isAngle ? of(this.name) / DEGREE : of(this.name); }
    set(value) { return this.changes({ [this.name]: this.isAngle ? value * DEGREE : value }); }
  }

  // A driver at the pose shown. Another value goes to the nearest pose; of several drivers this one alone goes there.
  class DriverRow extends Row {
    constructor(panel, _, driver) {
      super(panel, "the driver");
      Object.assign(this, { driver, values: driver.parts[""], label: driver.name, spoken: `value of ${driver.name}`, isAngle: driver.unit === "deg" });
      this.low = Math.min(...this.values);
      this.high = Math.max(...this.values);
    }
    get unit() { return this.isAngle ? "°" : page.raised(this.driver.unit); }
    get most() { return Infinity; }
    get step() { return (this.high - this.low) / Math.max(1, this.values.length - 1) || 1; }
    get() { return this.values[this.panel.player.pose]; }
    told() { return `from ${page.written(this.low)} to ${page.withUnit(this.high, this.driver.unit)}`; }
    wrong(text) {
      const value = this.value(text), slack = 1e-9 * (this.high - this.low);
      return value < this.low - slack || value > this.high + slack ? `It goes ${this.told()}.` : super.wrong(text);
    }
    move(value) {
      const { player } = this.panel, free = player.drivers.length > 1 && player.drag && player.drag.free;
      const index = player.data.live.drives.findIndex(({ name }) => name === this.driver.name);
      if (free && index >= 0) free.move(index, (value - this.get()) * (this.isAngle ? DEGREE : 1));
      else player.show(this.nearest(value));
    }
    // the pose whose value is nearest; of several the one nearest to the pose shown
    nearest(value) {
      const { pose } = this.panel.player, slack = 1e-9 * this.step;
      let best = pose;
      this.values.forEach((one, k) => {
        const nearer = Math.abs(one - value) - Math.abs(this.values[best] - value);
        if (nearer < -slack || (nearer <= slack && Math.abs(k - pose) < Math.abs(best - pose))) best = k;
      });
      return best;
    }
  }

  Object.assign(page, { PointRow, NumberRow, DriverRow, sizeOf, round });
})();
