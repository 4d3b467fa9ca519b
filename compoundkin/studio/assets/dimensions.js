// Dimensions: the browser solves the mechanism again by its program, as live pages do. What is dragged or typed is seen
// at once; the document changes, by the server, when it is let go.
import { element, labelled, parts } from "./elements.js";

const DRAGGED = 4; // pixels of a step of a number that is dragged
const REST = 700; // milliseconds after the last arrow until it is one step of undo

// an entry that is computed when it is first asked for: most points have no path that is drawn
const lazy = (holder, name, make) => {
  const put = (value) => Object.defineProperty(holder, name, { value, enumerable: true });
  Object.defineProperty(holder, name, { configurable: true, enumerable: true, get: () => put(make())[name] });
};

// A number that the browser's program does not have: teeth, a radius of a profile, the lift of a law. It is changed in the text.
class Count {
  constructor({ pair, entry, told, value, is_whole: isWhole, is_angle: isAngle }, unit) {
    Object.assign(this, { owner: pair, entry, label: told, spoken: told, value, isWhole, unit: isWhole ? "" : isAngle ? "°" : unit, step: isWhole ? 1 : value / 20 });
  }

  get() { return this.value; }

  wrong(text) {
    const value = Number(text);
    if (!(value > 0)) return "It must be greater than 0.";
    return this.isWhole && value % 1 ? "It must be a whole number." : "";
  }

  edit(value) { return { do: "count", pair: this.owner, entry: this.entry, value }; }
}

export class Dimensions {
  constructor(root, studio) {
    Object.assign(this, { studio, part: parts(root), fields: [], path: null, own: null, shown: "" });
    studio.canvas.before.push(() => this.#follow());
  }

  unmount() { clearTimeout(this.resting); }

  // the document is another
  async renew() {
    const { studio } = this, { text } = studio;
    [this.path, this.own, this.isFollowing, this.solved, this.original] = [null, null, false, null, null];
    this.part("dimensions-box").hidden = !studio.motion?.poses;
    if (!studio.motion?.poses) return;
    const reply = await studio.wire.ask({ document: text, question: { ask: "dimensions" } });
    if (text !== studio.text || reply.is_dropped) return;
    const why = reply.problems?.[0]?.what ?? reply.live?.why;
    if (why) { this.#rows([], why); return; }
    const page = window.compoundkin;
    this.live = reply.live;
    this.base = studio.motion;
    this.path = new page.Path(reply);
    this.own = this.path.own;
    this.index = new Map(this.path.names.map((name, k) => [name, k]));
    const size = (this.size = page.sizeOf(reply.live.dimensions)), of = (name) => this.own[this.index.get(name)];
    const panel = { size, unit: studio.unit, own: of, fixed: reply.live.panel.fixed };
    const rows = reply.live.panel.links.flatMap(({ name, rows: told }) => told.map((one) => new page.PointRow(panel, name, one)).filter((row) => !row.late));
    const numbers = reply.live.panel.pairs.flatMap(({ name, rows: told }) => told.map((one) => new page.NumberRow(panel, name, one)));
    this.#rows([...rows, ...numbers, ...reply.counts.map((one) => new Count(one, studio.unit))], "");
  }

  // fields stay where the rows are the same, so that who types goes on typing
  #rows(rows, why) {
    const key = rows.map(({ owner, label }) => `${owner} ${label}`).join();
    if (why || key !== this.shown || !this.fields.length) {
      this.fields = rows.map((row) => this.#field(row));
      const owners = [...new Set(rows.map(({ owner }) => owner))];
      const of = (owner) => this.fields.filter((one) => one.row.owner === owner).map((one) => one.root);
      this.part("dimensions").replaceChildren(...(why ? [element("p", why, { class: "quiet" })] : owners.map((owner) =>
        element("details", "", owner === "frame" ? {} : { open: "" }, element("summary", owner), ...of(owner)))));
      this.shown = key;
    }
    this.fields.forEach((field, k) => { field.row = rows[k]; });
    this.#write(null);
  }

  #of(numbers) { return (name) => numbers[this.index.get(name)]; }

  #write(but, numbers = this.own) {
    for (const { row, input } of this.fields) if (input !== but) input.value = this.#rounded(row.get(this.#of(numbers)));
  }

  // what is nothing but rounding is none
  #rounded(value) { return Math.abs(value) < 1e-9 * this.size ? 0 : Number(value.toPrecision(7)); }

  #field(row) {
    const id = `dimension-${row.owner}-${row.label}`.replace(/[^\w-]/g, "_");
    const input = element("input", "", { id, type: "number", step: "any" });
    const root = labelled(row.label, input), label = root.firstChild, field = { row, input, root };
    input.setAttribute("aria-label", `${row.spoken} of ${row.owner}`);
    root.append(element("span", row.unit, { class: "quiet" }));
    label.className = "scrub";
    label.title = "Drag it";
    const value = () => (input.value.trim() === "" ? NaN : Number(input.value));
    input.addEventListener("input", () => this.#see(field, value()));
    input.addEventListener("change", () => this.#take(field, value()));
    input.addEventListener("keydown", (event) => {
      const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!by) return;
      event.preventDefault();
      input.value = Number((value() + by * field.row.step * (event.shiftKey ? 10 : 1)).toPrecision(12));
      this.#see(field, value());
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.#take(field, value()), REST);
    });
    label.addEventListener("pointerdown", (event) => {
      if (!this.path) return;
      event.preventDefault();
      const start = event.clientX, begun = field.row.get(this.#of(this.own));
      label.setPointerCapture(event.pointerId);
      const move = (told) => {
        const by = field.row.isWhole ? 1 : field.row.step / 4;
        input.value = Number((begun + Math.round((told.clientX - start) / DRAGGED) * by).toPrecision(10));
        this.#see(field, value());
      };
      const end = () => {
        label.removeEventListener("pointermove", move);
        this.#take(field, value());
      };
      label.addEventListener("pointermove", move);
      label.addEventListener("pointerup", end, { once: true });
    });
    return field;
  }

  #numbers(found) {
    const numbers = Float64Array.from(this.own);
    for (const [name, value] of Object.entries(found)) if (this.index.has(name)) numbers[this.index.get(name)] = value;
    return numbers;
  }

  // at once, by the browser alone
  #see({ row, input }, value) {
    if (!this.path) return;
    const isWrong = !Number.isFinite(value) || row.wrong(String(value));
    input.setAttribute("aria-invalid", String(Boolean(isWrong)));
    if (isWrong) { this.studio.say(row.wrong(String(value)) || "Write a number."); return; }
    if (row.edit) return;
    const numbers = this.#numbers(row.set(value, this.#of(this.own))), { canvas } = this.studio;
    this.#write(input, numbers);
    this.#move(numbers);
    canvas.pose ??= this.base.start;
    canvas.draw();
  }

  #move(numbers) {
    const { canvas } = this.studio;
    this.solved = this.path.solved(numbers, this.solved ?? null, { rates: false });
    canvas.motion = this.#motion(numbers);
  }

  // as the server tells a motion
  #motion(numbers) {
    const { links, assembled } = this.solved, { base } = this, of = this.#of(numbers), fixed = this.live.panel.fixed;
    const order = new Map(this.names.map((name, k) => [name, k]));
    const at = (link, letter) => ["x", "y"].map((axis, k) => of(`${link}.${letter}.${axis}`) ?? fixed[link]?.[letter]?.[k]);
    const told = (values) => Array.from(values, (one) => (Number.isFinite(one) ? one : null));
    const points = { ...base.points }, origins = { ...base.origins }, known = new Set();
    for (const { name, points: letters } of this.studio.structure.links) {
      const own = links[order.get(name)];
      if (!own) continue;
      if (base.origins[name]) lazy(origins, name, () => [told(own.x), told(own.y), Array.from(own.angle)]);
      for (const letter of letters) {
        const [px, py] = at(name, letter);
        if (known.has(letter) || px === undefined) continue;
        known.add(letter);
        lazy(points, letter, () => {
          const xs = Float64Array.from(own.x, (x, k) => x + Math.cos(own.angle[k]) * px - Math.sin(own.angle[k]) * py);
          return [told(xs), told(Float64Array.from(own.y, (y, k) => y + Math.sin(own.angle[k]) * px + Math.cos(own.angle[k]) * py))];
        });
      }
    }
    return { ...base, points, origins, assembled: Array.from(assembled), gaps: [] };
  }

  get names() { return this.studio.structure.links.map(({ name }) => name); }

  // what is let go becomes one edit
  #take({ row, input }, value) {
    clearTimeout(this.resting);
    if (!this.path || input.getAttribute("aria-invalid") === "true") return;
    if (row.edit) {
      if (value !== row.get()) this.studio.edit(row.edit(value), () => this.#back());
      return;
    }
    const values = row.set(value, this.#of(this.own)), isSame = Object.entries(values).every(([name, one]) => one === this.own[this.index.get(name)]);
    if (isSame) return;
    this.studio.edit({ do: "dimensions", values }, () => this.#back());
  }

  // refused: the motion is the document's again
  #back() {
    if (!this.path) return;
    this.solved = null;
    this.studio.canvas.motion = this.base;
    this.#write(null);
    this.studio.canvas.draw();
  }

  // while points are dragged the paths follow them
  #follow() {
    const { canvas } = this.studio, letters = Object.keys(canvas.moved);
    if (!this.path || (!letters.length && !this.isFollowing)) return;
    if (!letters.length) {
      [this.isFollowing, this.solved] = [false, null];
      if (canvas.motion) canvas.motion = this.base;
      return;
    }
    const k = canvas.pose ?? this.base.start, original = (this.original ??= this.path.solved(this.own, null, { rates: false })), found = {};
    this.names.forEach((name, n) => {
      const { x, y, angle } = original.links[n] ?? {};
      if (!x || !Number.isFinite(x[k])) return;
      const [c, s] = [Math.cos(angle[k]), Math.sin(angle[k])];
      for (const letter of letters) {
        if (!this.index.has(`${name}.${letter}.x`)) continue;
        const [dx, dy] = [canvas.moved[letter][0] - x[k], canvas.moved[letter][1] - y[k]];
        [found[`${name}.${letter}.x`], found[`${name}.${letter}.y`]] = [c * dx + s * dy, c * dy - s * dx];
      }
    });
    this.isFollowing = true;
    this.#move(this.#numbers(found));
  }
}
