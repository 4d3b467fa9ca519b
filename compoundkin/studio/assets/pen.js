// A curve drawn by hand, and the linkages that trace it: the nearest of an atlas at once, better ones as they come.
import { element, parts, svgElement } from "./elements.js";

// A curve is closed when it ends so near to its beginning, in pixels, or in parts of its length; one that is shorter is
// none. Points are sent evenly along it, so many. A thumbnail is so wide and high.
const CLOSE = 26, CLOSER = 0.06, SHORTEST = 60, SENT = 120, WIDE = 160, HIGH = 120, MARGIN = 8;
const STEPS = [
  ["near", "The nearest of the atlas; refining them …"],
  ["fitted", "Refined; searching further …"],
  ["traced", "Searched, refined and verified."],
];

const gap = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const path = (places, isClosed) => (places.length ? `M${places.map((one) => one.map((n) => n.toFixed(1)).join(" ")).join("L")}${isClosed ? "Z" : ""}` : "");
const length = (places) => places.reduce((sum, one, k) => sum + (k ? gap(places[k - 1], one) : 0), 0);

// so many places evenly along a line; of a closed one without the first again
const even = (places, count, isClosed) => {
  const line = isClosed ? [...places, places[0]] : places, step = length(line) / (isClosed ? count : count - 1);
  const found = [line[0]];
  let along = 0;
  for (let k = 1; k < line.length && found.length < count; k += 1) {
    const [a, b] = [line[k - 1], line[k]], long = gap(a, b);
    while (found.length < count && found.length * step <= along + long * (1 + 1e-9)) {
      const part = long ? (found.length * step - along) / long : 0;
      found.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
    }
    along += long;
  }
  return found;
};

export class Pen {
  constructor(root, studio) {
    // the curve in the plane of the mechanism; `round` counts searches: replies of an older one are not shown
    Object.assign(this, { studio, places: [], isClosed: true, isDone: false, suggestions: [], chosen: null, round: 0 });
    this.part = parts(root);
    this.layer = svgElement("g", { class: "layer-pen" }, studio.canvas.svg);
    studio.canvas.after.push(() => this.#draw());
    this.#build();
  }

  #build() {
    this.kind = element("select", "", { id: "pen-kind", "aria-label": "What is drawn" }, element("option", "closed curve", { value: "closed" }), element("option", "stroke", { value: "open" }));
    this.links = element("select", "", { id: "pen-links", "aria-label": "Links of a linkage" }, ...[4, 6, 8].map((one) => element("option", `${one} links at most`, { value: one })));
    this.links.value = 6;
    for (const one of [this.kind, this.links]) {
      one.addEventListener("change", () => { this.isClosed = this.kind.value === "closed"; this.studio.canvas.draw(); this.#search(); });
    }
    const clear = element("button", "Clear", { id: "pen-clear" });
    clear.addEventListener("click", () => this.clear());
    this.further = element("button", "Search further", { id: "pen-further", hidden: "" });
    this.further.addEventListener("click", () => { this.further.hidden = true; this.#search([STEPS[2]]); });
    this.better = element("button", "Show better ones", { id: "pen-better", hidden: "" });
    this.better.addEventListener("click", () => this.#list());
    this.words = element("p", "", { class: "quiet", role: "status", id: "pen-words" });
    this.list = element("div", "", { class: "thumbnails", id: "pen-list" });
    this.box = element("section", "", { id: "pen-box", "aria-labelledby": "head-pen", hidden: "" },
      element("h2", "Linkages for the curve", { id: "head-pen" }),
      element("div", "", { class: "bar field" }, this.kind, this.links, clear),
      this.words, element("div", "", { class: "bar" }, this.better, this.further), this.list);
    this.studio.root.querySelector("aside").prepend(this.box);
  }

  unmount() {
    this.round += 1;
    this.layer.remove();
    this.box.remove();
  }

  // the tool is taken: the atlas is made meanwhile
  take() {
    this.box.hidden = false;
    if (!this.isDone) this.#say("Draw on the canvas: a curve that ends where it began is closed, any other a stroke.");
    if (!this.hasAtlas) { this.hasAtlas = true; this.studio.wire.ask({ document: "", question: { ask: "atlas" } }); }
  }

  // --- the gesture, in places of the screen

  begin(at) {
    this.clear(true);
    this.follow(at);
  }

  follow(at) {
    const place = this.studio.canvas.plane(at), last = this.places.at(-1);
    if (!last || gap(last, place) * this.studio.canvas.view.scale >= 1) this.places.push(place);
    this.#draw();
  }

  end() {
    const { scale } = this.studio.canvas.view, long = length(this.places) * scale;
    if (long < SHORTEST) { this.clear(); this.#say("That is too short for a curve."); return; }
    this.isClosed = gap(this.places[0], this.places.at(-1)) * scale <= Math.max(CLOSE, CLOSER * long);
    this.kind.value = this.isClosed ? "closed" : "open";
    this.isDone = true;
    this.#search();
  }

  clear(isBegun = false) {
    this.round += 1;
    Object.assign(this, { places: [], isDone: false, suggestions: [], chosen: null });
    this.further.hidden = true;
    this.#list();
    this.#say("");
    this.box.hidden = !isBegun && this.studio.gestures.tool !== "pen";
    this.studio.canvas.draw();
  }

  // --- suggestions

  get curve() { return even(this.places, SENT, this.isClosed); }

  async #search(steps = this.studio.isKept ? STEPS.slice(0, 2) : STEPS) {
    if (!this.isDone) return;
    this.round += 1;
    const { round } = this, question = { points: this.curve, closed: this.isClosed, links: Number(this.links.value) };
    if (steps.length > 1) { this.suggestions = []; this.chosen = null; this.#list(); }
    this.box.setAttribute("aria-busy", "true");
    this.#say(steps.length > 1 ? "Looking for linkages …" : "Searching further …");
    for (const [ask, words] of steps) {
      const reply = await this.studio.wire.ask({ document: "", question: { ask, ...question } });
      if (round !== this.round || reply.is_dropped) return;
      if (reply.problems?.length) {
        const [{ what, remedy }] = reply.problems;
        this.#say(remedy ? `${what}: ${remedy}` : what);
        if (!this.suggestions.length) break;
      } else if (reply.suggestions.length) {
        this.suggestions = reply.suggestions;
        // what is pointed at does not become another one under the pointer
        this.better.hidden = !this.list.childElementCount || !this.list.matches(":hover, :focus-within");
        if (this.better.hidden) this.#list();
        this.#say(ask === steps.at(-1)[0] && ask !== "traced" ? "Refined." : words);
      } else if (!this.suggestions.length) this.#say("No linkage comes near.");
    }
    this.further.hidden = steps.at(-1)[0] === "traced";
    this.box.removeAttribute("aria-busy");
  }

  #say(words) { this.words.textContent = words; }

  #list() {
    this.better.hidden = true;
    this.list.replaceChildren(...this.suggestions.map((one, k) => this.#thumbnail(one, k)));
  }

  #thumbnail(one, k) {
    const { title, links, error } = one, unit = this.studio.unit ? ` ${this.studio.unit}` : "";
    const words = `${title}: ${links} links, off by ${error}${unit}`;
    const button = element("button", "", { class: "thumbnail", "aria-label": words, "aria-pressed": String(this.chosen === one.text), "data-links": links, "data-error": error }, this.#picture(one),
      element("span", title, { class: "title" }), element("span", `${links} links, off by ${error}${unit}`, { class: "quiet" }));
    button.addEventListener("click", () => this.#choose(k));
    return button;
  }

  // the linkage at the pose that it is drawn at, the path of its point, the curve
  #picture({ path: [xs, ys], points, bars, ground }) {
    const line = xs.map((x, k) => [x, ys[k]]), all = [...line, ...this.places, ...Object.values(points)];
    const [[left, right], [low, top]] = [0, 1].map((axis) => { const own = all.map((one) => one[axis]); return [Math.min(...own), Math.max(...own)]; });
    const scale = Math.min((WIDE - 2 * MARGIN) / (right - left || 1), (HIGH - 2 * MARGIN) / (top - low || 1));
    const at = ([x, y]) => [WIDE / 2 + (x - (left + right) / 2) * scale, HIGH / 2 - (y - (low + top) / 2) * scale];
    const svg = svgElement("svg", { viewBox: `0 0 ${WIDE} ${HIGH}`, "aria-hidden": "true" });
    svgElement("path", { d: path(this.places.map(at), this.isClosed), class: "sketched" }, svg);
    svgElement("path", { d: path(line.map(at), false), class: "traced" }, svg);
    for (const letters of bars) svgElement("path", { d: path(letters.map((one) => at(points[one])), letters.length > 2), class: "rod-of" }, svg);
    for (const [letter, place] of Object.entries(points)) {
      const [x, y] = at(place);
      svgElement("circle", { cx: x, cy: y, r: letter === "P" ? 3.4 : 2.4, class: letter === "P" ? "tracing" : ground.includes(letter) ? "fixed" : "joint" }, svg);
    }
    return svg;
  }

  // one that is chosen is the document; undo leads back
  #choose(k) {
    const { text, title, error } = this.suggestions[k];
    this.chosen = text;
    for (const [n, one] of [...this.list.children].entries()) one.setAttribute("aria-pressed", String(this.suggestions[n]?.text === text));
    [this.studio.isFitted, this.studio.isOpened] = [false, true];
    this.studio.choose("move");
    this.studio.put(text);
    this.studio.say(`${title}, off by ${error}: press space. Undo brings back what was drawn`);
  }

  // --- on the canvas

  #draw() {
    this.layer.replaceChildren();
    if (this.places.length < 2) return;
    svgElement("path", { d: path(this.places.map((one) => this.studio.canvas.screen(one)), this.isDone && this.isClosed), class: "sketched" }, this.layer);
  }
}
