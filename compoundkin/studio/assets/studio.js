// The window: a history of whole documents, the wire that questions go over, the panels. It draws what it is told.
import { Canvas } from "./canvas.js";
import { Dimensions } from "./dimensions.js";
import { element, parts } from "./elements.js";
import { Gestures } from "./gestures.js";
import { Pen } from "./pen.js";
import { Results } from "./results.js";

const MOST_KEPT = 200, TYPING = 900, PAUSE = 250;
// Keys for what is under the pointer or chosen, and for tools.
const ACTS = { g: "ground", d: "driver", s: "slide", p: "point", w: "weld", r: "gear", k: "cam", t: "trace", l: "lock", delete: "delete", backspace: "delete" };
const TOOLS = { b: "draw", v: "move", c: "cylinder", i: "pen" };

export class Studio {
  // `root` is the element of the window; `kept` is the history of before and keeps what it is given. A window that is
  // `alone` hears the keys of its whole page.
  constructor(root, { wire, kept = {}, alone = false }) {
    Object.assign(this, { root, part: parts(root), kept, token: kept.token ?? "", alone, ended: new AbortController() });
    this.canvas = new Canvas(this.part("canvas"));
    this.gestures = new Gestures(this.canvas, this);
    this.history = [];
    this.place = 0;
    this.mark = "";
    this.saved = null;
    this.queue = Promise.resolve();
    this.typed = 0;
    this.edits = 0;
    this.asking = {};
    this.isFitted = false;
    this.before = kept.before ?? null;
    this.results = new Results(root, this);
    this.pen = new Pen(root, this);
    this.dimensions = new Dimensions(root, this);
    this.#listen();
    this.wire = wire({ opened: (reply) => this.#open(reply), lost: (wasOpen) => this.#lost(wasOpen) });
  }

  // nothing of it listens or waits any more
  unmount() {
    this.halt();
    clearTimeout(this.pause);
    this.gestures.closeMenu();
    this.ended.abort();
    this.results.unmount();
    this.pen.unmount();
    this.dimensions.unmount();
    this.canvas.unmount();
    this.wire.end();
  }

  // also inside a shadow root
  get focused() { return this.root.getRootNode().activeElement; }
  get text() { return this.history[this.place] ?? ""; }
  get structure() { return this.canvas.structure; }
  get motion() { return this.canvas.motion; }
  get isSettled() { return this.edits === 0 && this.shown === this.text && this.file !== undefined; }
  get unit() { return this.structure?.unit ?? ""; }

  // --- the document and its history

  #open({ text, mark, file, folder, is_new: isNew, is_given: isGiven, is_kept: isKept }) {
    const isAgain = this.file !== undefined;
    this.part("save").disabled = false;
    // a notebook has what is drawn at each step
    this.isKept = Boolean(isKept);
    this.part("save").hidden = this.part("state").hidden = this.isKept;
    if (isGiven) { this.put(text); return; }
    if (isAgain) {
      // the server has come back: what is here goes on, and what is on disk is looked at when it is saved
      if (this.isLost) this.#notice("");
      this.isLost = false;
      return;
    }
    this.file = file;
    this.part("file").textContent = file;
    this.part("file").title = folder;
    if (this.alone) document.title = `${file} - studio`;
    [this.history, this.place, this.mark] = [[text], 0, mark];
    this.saved = isNew ? null : text;
    if (this.before?.history?.length) {
      ({ history: this.history, place: this.place } = this.before);
      if (this.before.mark === mark) this.saved = this.before.saved;
      else [this.mark, this.saved] = [this.before.mark, this.before.saved];
    }
    this.#show();
    this.choose(/^\s*\[links/m.test(this.text) ? "move" : "draw");
  }

  get stem() { return (this.file ?? "mechanism").replace(/\.[^.]*$/, ""); }

  #keep() {
    const { token, history: texts, place, mark, saved } = this;
    this.kept.keep?.({ token, history: texts, place, mark, saved });
  }

  #lost(wasOpen) {
    this.isLost = true;
    const again = wasOpen ? "It goes on here when that has started again; until then" : "Start it again, or";
    this.#notice(`The studio on this machine has ended, or did not let this window in. The drawing is kept here. ${again} copy its text or save a copy: compoundkin studio ${this.file ?? ""}`,
      ["Save a copy", () => { this.results.copy(); this.#lost(wasOpen); }]);
    this.part("save").disabled = true;
  }

  #notice(text, ...choices) {
    const box = this.part("notice");
    box.hidden = !text;
    box.replaceChildren(text ?? "");
    for (const [words, run] of choices) {
      const button = element("button", words);
      button.addEventListener("click", () => { box.hidden = true; run(); });
      box.append(button);
    }
  }

  // one entry for each gesture
  put(text, isTyped = false, structure = null) {
    // a browser's field has one kind of line ends, a file from Windows another
    if (isTyped && this.text.includes("\r\n")) text = text.replaceAll(/\r?\n/g, "\r\n");
    if (text === this.text) return;
    const isOn = isTyped && performance.now() - this.typed < TYPING && this.place;
    this.history.splice(this.place + (isOn ? 0 : 1), Infinity, text);
    if (this.history.length > MOST_KEPT) this.history.splice(0, this.history.length - MOST_KEPT);
    this.place = this.history.length - 1;
    this.typed = isTyped ? performance.now() : 0;
    this.#show(isTyped, structure);
  }

  step(by) {
    const place = this.place + by;
    if (place < 0 || place >= this.history.length) return;
    this.place = place;
    this.typed = 0;
    this.#show();
  }

  // an edit follows the one before it, of whose text it is
  edit(edit, refused = () => {}) {
    const pose = this.canvas.pose;
    if (pose !== null && !this.canvas.isShown(pose)) {
      this.say("Not done: it is not assembled at this pose; go to one that is, or press As drawn");
      refused();
      return this.queue;
    }
    this.edits += 1;
    this.queue = this.queue.then(async () => {
      const text = this.text, reply = await this.wire.ask({ document: text, question: { ask: "edit", edit, pose, with: "structure" } });
      if (text !== this.text) return;
      if (reply.problems?.length) {
        const [{ what, remedy }] = reply.problems;
        this.say(`Not done: ${what}${remedy ? `; ${remedy}` : ""}`);
        refused();
        return;
      }
      const { made } = reply;
      if (made?.points?.length && edit.do !== "point") this.canvas.chosen = { point: made.points.at(-1) };
      this.goTo = made?.pose ?? (this.structure?.is_as_drawn ? null : pose);
      this.put(reply.text, false, reply.structure);
    }).finally(() => { this.edits -= 1; });
    return this.queue;
  }

  ask(question) { return this.wire.ask({ document: this.text, question }); }

  // where points would go by an edit, while its gesture lasts
  async preview(edit) {
    this.newest = edit;
    if (this.isPreviewing) return;
    this.isPreviewing = true;
    while (this.newest) {
      const asked = this.newest;
      this.newest = null;
      const { made, problems } = await this.ask({ ask: "edit", edit: asked, pose: this.canvas.pose });
      if (!this.gestures.held) break;
      this.canvas.moved = made?.places ?? {};
      this.canvas.draw();
      if (problems?.length) this.say(`Not there: ${problems[0].what}`);
    }
    [this.newest, this.isPreviewing] = [null, false];
  }

  async save(mark = this.mark) {
    const text = this.text, reply = await this.wire.ask({ document: text, save: true, mark });
    if (reply.is_saved) {
      [this.mark, this.saved] = [reply.mark, text];
      this.say(`Saved ${this.file}`);
    } else if (reply.why) {
      this.#notice(`Not saved: ${reply.why}`, ["Close", () => {}]);
    } else {
      this.#notice(`${this.file} has changed on disk since it was read here.`,
        ["Replace it by this drawing", () => this.save(reply.mark)],
        ["Take the file's text", () => { [this.mark, this.saved] = [reply.mark, reply.disk]; this.put(reply.disk); }]);
    }
    this.#state();
  }

  // --- what follows from the text: the structure, then the motion

  #show(isTyped = false, structure = null) {
    if (!isTyped || this.part("text").value !== this.text.replaceAll("\r\n", "\n")) this.part("text").value = this.text;
    this.#state();
    this.#keep();
    this.halt();
    // an edit brings it along; one that is under way is then of an older text, and is asked again
    if (structure && !this.asking.structure) { this.#structured({ problems: [], ...structure }, this.text); return; }
    this.#latest("structure", (reply, text) => this.#structured(reply, text));
  }

  // one question of a kind is under way; when its text is not the newest any more, it is asked again
  async #latest(ask, take) {
    if (this.asking[ask]) return;
    this.asking[ask] = true;
    let text, reply;
    do {
      text = this.text;
      reply = await this.wire.ask({ document: text, question: { ask } });
    } while (text !== this.text);
    this.asking[ask] = false;
    take(reply, text);
  }

  #structured(structure, text) {
    this.known = text;
    this.problems = structure.problems ?? [];
    this.#problems(this.problems);
    if (!structure.is_text) { this.shown = text; return; }
    this.canvas.motion = null;
    this.canvas.pose = null;
    this.#forget(structure);
    this.canvas.show(structure);
    this.#panels(structure);
    if (structure.moves || structure.may_move) this.#latest("motion", (reply, asked) => this.#moved(reply, asked));
    else this.#finish(text);
  }

  #moved(motion, text) {
    // the structure of a newer text asks again
    if (text !== this.known) return;
    this.#problems([...this.problems, ...(motion.problems ?? [])]);
    // it moves though it is overconstrained, which near the drawing could not be seen
    if (motion.structure) { this.canvas.structure = motion.structure; this.#panels(motion.structure); }
    if (motion.poses) {
      this.canvas.motion = motion;
      if (this.goTo !== null && this.goTo !== undefined && this.canvas.isShown(this.goTo)) this.canvas.pose = this.goTo;
      this.#gaps(motion);
    }
    this.#finish(text);
  }

  #finish(text) {
    this.goTo = null;
    if (!this.isFitted && this.structure.links.length) {
      // a file that is opened is seen whole; one that is drawn keeps its scale
      if (this.history.length === 1 || this.isOpened) this.canvas.fit();
      this.isOpened = false;
      this.isFitted = true;
    }
    this.#driver();
    this.canvas.draw();
    this.shown = text;
    this.dimensions.renew();
    this.results.renew();
  }

  // what is chosen may be no more
  #forget({ points, links, pairs }) {
    const isThere = (it) => it && (it.point ? it.point in points : it.pair ? pairs.some((one) => one.name === it.pair) : links.some((one) => one.name === it.link));
    for (const key of ["chosen", "over"]) if (!isThere(this.canvas[key])) this.canvas[key] = null;
    for (const letter of this.canvas.picked) if (!(letter in points)) this.canvas.picked.delete(letter);
  }

  #state() {
    const isSaved = this.text === this.saved;
    this.part("state").textContent = isSaved ? "saved" : "not saved";
    this.part("undo").disabled = this.place === 0;
    this.part("redo").disabled = this.place >= this.history.length - 1;
  }

  #problems(problems) {
    this.part("problems").replaceChildren(...problems.map(({ where, what, remedy }) => {
      const line = element("li", where ? `${where}: ${what}` : what);
      if (remedy) line.append(element("span", remedy, { class: "remedy" }));
      return line;
    }));
  }

  #panels({ mobility, faults, links, groups, drives, points, moves, pairs }) {
    const chip = this.part("chip"), missing = mobility.freedoms - drives.length, isFixed = links.some((one) => one.name === "frame");
    const less = !isFixed ? "no frame" : missing > 0 ? `${missing} driver${missing > 1 ? "s" : ""} missing` : missing < 0 ? `${-missing} too many` : "";
    chip.textContent = `${mobility.sum}${moves ? ": moves" : less && links.length ? `: ${less}` : ""}`;
    chip.className = `chip ${moves ? "good" : links.length ? "bad" : ""}`;
    this.part("faults").replaceChildren(...faults.map(({ what, remedy, fixes }) => {
      const line = element("li", what);
      line.append(element("span", remedy, { class: "remedy" }));
      for (const { words, edit } of fixes) {
        const button = element("button", words[0].toUpperCase() + words.slice(1));
        button.addEventListener("click", () => this.edit(edit));
        line.append(button);
      }
      return line;
    }));
    if (!faults.length) this.part("faults").append(element("li", "Nothing: it moves.", { class: "good" }));
    const row = (head, ...inner) => element("div", "", { class: "row" }, head, ...inner);
    const pick = (words, it) => {
      const button = element("button", words);
      button.addEventListener("click", () => { this.canvas.chosen = it; this.canvas.draw(); this.part("canvas").focus({ preventScroll: true }); });
      return button;
    };
    const linksOf = (names) => names.filter((name) => name !== "frame").map((name) => pick(name, { link: name }));
    const swatch = (k) => element("i", "", { class: `swatch g${k === 0 ? 0 : ((k - 1) % 7) + 1}` });
    const grouped = new Set(groups.flatMap((one) => one.links));
    const rest = links.filter((one) => !one.is_aside && !grouped.has(one.name)).map((one) => one.name);
    const loose = links.filter((one) => one.is_aside).map((one) => one.name);
    const rows = groups.map((group) => row(swatch(group.colour), element("span", group.name), ...linksOf(group.links)));
    if (linksOf(rest).length) rows.unshift(row(swatch(0), element("span", moves ? "driven" : "links"), ...linksOf(rest)));
    if (loose.length) rows.push(row(element("span", "loose"), ...linksOf(loose)));
    if (Object.keys(points).length) rows.push(row(element("span", "points"), ...Object.keys(points).map((one) => pick(one, { point: one }))));
    const other = pairs.filter((one) => one.code !== "P" && !one.shapes?.length).map((one) => `${one.name} (${one.kind})`);
    if (other.length) rows.push(row(element("span", `drawn by their points only: ${other.join(", ")}`, { class: "quiet" })));
    this.part("structure").replaceChildren(...rows);
  }

  #gaps({ gaps }) {
    for (const { why, links } of gaps.slice(0, 3)) {
      const line = element("li", `Not assembled all the way: ${why}`);
      line.append(element("span", links.join(", "), { class: "remedy" }));
      this.part("faults").append(line);
    }
  }

  // --- the driver

  #driver() {
    const { motion, canvas } = this, box = this.part("drive");
    box.hidden = !motion?.poses;
    if (box.hidden) return;
    const at = canvas.pose ?? motion.start, [[name, { values, unit }]] = Object.entries(motion.drives);
    this.part("pose").max = motion.poses - 1;
    this.part("pose").value = at;
    this.part("pose").setAttribute("aria-label", `Driver ${name}`);
    const shown = `${Number(values[at].toPrecision(5))}${unit === "°" ? unit : ` ${unit}`}`;
    this.part("pose").setAttribute("aria-valuetext", shown);
    const gap = canvas.pose !== null && !canvas.isShown(at) ? motion.gaps.find((one) => one.from <= at && at <= one.to) : null;
    this.part("value").textContent = canvas.pose === null ? "as drawn" : shown;
    this.part("why").textContent = gap ? `Not assembled: ${gap.why}. What is known is drawn; the circles do not meet.` : "";
  }

  pose(k) {
    this.canvas.pose = k;
    this.canvas.draw();
    this.#driver();
    this.results.posed();
    return this.canvas.isShown(k);
  }

  // the pose at which a point of the driven link is nearest to a place
  drive(letter, [x, y]) {
    const [xs, ys] = this.motion?.points[letter] ?? [[], []];
    let best = -1, near = Infinity;
    xs.forEach((one, k) => {
      const away = one === null ? Infinity : Math.hypot(one - x, ys[k] - y);
      if (away < near) [best, near] = [k, away];
    });
    if (best >= 0) this.pose(best);
  }

  play() {
    if (!this.motion?.poses || this.playing) { this.halt(); return; }
    this.part("play").textContent = "Pause";
    let k = this.canvas.pose ?? this.motion.start, by = 1;
    const last = this.motion.poses - 1;
    const [xs, ys] = Object.values(this.motion.points).at(-1);
    const isRound = this.motion.assembled.every(Boolean) && Math.hypot(xs[0] - xs[last], ys[0] - ys[last]) < 1e-3 * Math.max(1, ...xs.map(Math.abs));
    const next = () => {
      let to = k + by;
      if (isRound) to = (to + last) % last;
      else if (to < 0 || to > last || !this.canvas.isShown(to)) { by = -by; to = k + by; }
      if (this.canvas.isShown(to) && this.pose(to)) k = to;
      this.playing = requestAnimationFrame(next);
    };
    this.playing = requestAnimationFrame(next);
  }

  halt() {
    cancelAnimationFrame(this.playing);
    this.playing = null;
    this.part("play").textContent = "Play";
  }

  // --- what gestures ask, and keys

  linksAt(letter) { return this.structure?.links.filter((one) => one.points.includes(letter)).map((one) => one.name) ?? []; }
  driveAt(letter) { return this.structure?.drives.find((one) => one.points[0] === letter && !this.canvas.cylinder(one.name))?.name; }
  slideAt(letter) { return this.structure?.pairs.find((one) => one.code === "P" && !one.is_cylinder && one.points[0] === letter)?.name; }
  say(text) { this.part("hint").textContent = text; }

  choose(tool) {
    this.gestures.choose(tool);
    if (tool === "pen") this.pen.take();
    for (const one of Object.values(TOOLS)) this.part(`tool-${one}`).setAttribute("aria-pressed", String(one === tool));
  }

  #listen() {
    const on = (id, run) => this.part(id).addEventListener("click", run);
    on("undo", () => this.step(-1));
    on("redo", () => this.step(1));
    on("save", () => this.save());
    on("open", () => this.results.open());
    on("copy", () => this.results.copy());
    on("export", () => this.results.exports());
    on("unit", () => this.gestures.unit());
    on("more", () => this.#more(this.part("more").getAttribute("aria-expanded") !== "true"));
    for (const one of ["open", "copy", "export", "unit"]) on(one, () => this.#more(false));
    on("fit", () => this.canvas.fit());
    on("play", () => this.play());
    on("home", () => { this.halt(); this.canvas.pose = null; this.canvas.draw(); this.#driver(); });
    for (const tool of Object.values(TOOLS)) on(`tool-${tool}`, () => this.choose(tool));
    on("add-photo", () => this.part("photo").click());
    this.part("photo").addEventListener("change", ({ target }) => { this.gestures.photograph(target.files[0]); target.value = ""; });
    for (const what of ["ground", "driver", "slide", "gear", "cam", "lock", "delete"]) {
      // what is under the pointer is the button
      on(`do-${what}`, () => { this.canvas.over = null; this.gestures.act(what); });
    }
    this.part("pose").addEventListener("input", (event) => { this.halt(); this.pose(Number(event.target.value)); });
    this.part("text").addEventListener("input", (event) => {
      clearTimeout(this.pause);
      this.pause = setTimeout(() => this.put(event.target.value, true), PAUSE);
    });
    const { signal } = this.ended;
    (this.alone ? document : this.root).addEventListener("keydown", (event) => this.#key(event), { signal });
    document.addEventListener("pointerdown", (event) => { if (!event.composedPath().includes(this.part("more").parentElement)) this.#more(false); }, { signal, capture: true });
    if (this.alone) addEventListener("beforeunload", (event) => { if (this.text !== this.saved && this.history.length > 1) event.preventDefault(); }, { signal });
  }

  // the menu of what is rare, where the window is too narrow for it
  #more(isOpen) { this.part("more").setAttribute("aria-expanded", String(isOpen)); }

  #key(event) {
    const key = event.key.toLowerCase(), isCommand = event.ctrlKey || event.metaKey;
    const isText = event.target.matches("textarea, input:not([type=range]):not([type=radio]), select"), isButton = event.target.matches("button, input, summary");
    if (event.target.closest("dialog")) return;
    if (!isText && !isCommand && !(isButton && key === "enter") && this.gestures.key(event)) { event.preventDefault(); return; }
    if (isCommand && key === "s") this.save();
    else if (isCommand && key === "z") this.step(event.shiftKey ? 1 : -1);
    else if (isCommand && key === "y") this.step(1);
    else if (isCommand && key === "a" && !isText) this.gestures.pickAll();
    else if (isText || isCommand || event.altKey || (isButton && [" ", "enter", "arrowleft", "arrowright", "arrowup", "arrowdown"].includes(key))) return;
    else if (key === "contextmenu" || (key === "f10" && event.shiftKey)) this.gestures.menuOfKey();
    else if (key in ACTS) this.gestures.act(ACTS[key]);
    else if (key in TOOLS) this.choose(TOOLS[key]);
    else if (key === "n") this.gestures.bar();
    else if (key === "f") this.canvas.fit();
    else if (key === " ") this.play();
    else if (key === "escape" && this.part("more").getAttribute("aria-expanded") === "true") { this.#more(false); this.part("more").focus(); }
    else if (key === "escape") {
      this.gestures.stop();
      this.canvas.chosen = null;
      this.canvas.picked.clear();
      if (this.gestures.tool !== "draw") this.choose("move");
      this.canvas.draw();
    }
    else if (key.startsWith("arrow")) this.gestures.nudge({ arrowleft: [-8, 0], arrowright: [8, 0], arrowup: [0, -8], arrowdown: [0, 8] }[key]);
    else return;
    event.preventDefault();
  }
}
