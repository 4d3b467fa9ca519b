// What was found of the mechanism: plots, reports, configurations, circuits; velocities and instant centres on the
// canvas; opening and exporting. Each is asked when somebody looks at it, after the motion is there.
import { element, fragment, labelled, parts, svgElement } from "./elements.js";

const LONGEST = 110, DOT = 4; // pixels: the longest velocity, the dot of a centre
const COLOUR = { centres: "var(--bad)", velocities: "var(--good)", load: "var(--bad)", force: "var(--ink)" };
const SWEEP = 2.6, ROUND = 20, FAINT = 0.02; // the arc of a moment, and parts of the greatest that are not drawn

const offered = (name, content, type) => {
  const address = URL.createObjectURL(new Blob([content], { type }));
  const link = element("a", "", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
};

export class Results {
  constructor(root, studio) {
    Object.assign(this, { studio, part: parts(root), shown: {}, chosen: [], words: null });
    this.layer = svgElement("g", { class: "layer-found" }, studio.canvas.svg);
    this.#build();
    studio.canvas.after.push(() => this.#draw());
  }

  // --- panels that ask when they are open

  #build() {
    const box = this.part("results");
    this.panels = {};
    for (const [ask, title] of [["plots", "Plots"], ["configurations", "Configurations"], ["circuits", "Circuits"], ["forces", "Forces"], ["results", "Report"]]) {
      const body = element("div", "", { class: "found" });
      const panel = element("details", "", { id: `results-${ask}` }, element("summary", title), body);
      panel.addEventListener("toggle", () => { if (panel.open) this.#ask(ask); });
      this.panels[ask] = { panel, body };
      box.append(panel);
    }
    const switches = element("div", "", { class: "bar switches", role: "group", "aria-label": "On the canvas" });
    this.switches = {};
    for (const [name, title] of [["paths", "Paths"], ["velocities", "Velocities"], ["centres", "Instant centres"], ["forces", "Forces"]]) {
      const button = element("button", title, { id: `show-${name}`, "aria-pressed": String(name === "paths") });
      button.addEventListener("click", () => this.#toggle(name, button));
      this.switches[name] = button;
      switches.append(button);
    }
    box.prepend(switches);
  }

  get isMoving() { return Boolean(this.studio.motion?.poses); }

  // the document is another: what is looked at is asked anew; the rest is forgotten
  renew() {
    this.shown = {};
    this.overlay = null;
    this.part("results-box").hidden = !this.studio.structure?.links.length;
    for (const [ask, { panel, body }] of Object.entries(this.panels)) {
      if (panel.open) { body.setAttribute("aria-busy", "true"); this.#ask(ask); } else body.replaceChildren();
    }
    if (["velocities", "centres", "forces"].some((one) => this.isOn(one))) this.#overlays();
  }

  // another pose is shown: configurations are those of its driver
  posed() {
    if (this.panels.configurations.panel.open) {
      clearTimeout(this.posing);
      this.posing = setTimeout(() => { delete this.shown.configurations; this.#ask("configurations"); }, 250);
    }
  }

  unmount() {
    clearTimeout(this.posing);
    this.layer.remove();
  }

  async #reply(ask, more = {}) {
    const text = this.studio.text, reply = await this.studio.wire.ask({ document: text, question: { ask, ...more } });
    return text === this.studio.text && !reply.is_dropped ? reply : null;
  }

  async #ask(ask) {
    const { body, panel } = this.panels[ask], { text } = this.studio;
    if (this.shown[ask] === text) return;
    if (ask === "plots" && !this.words) { await this.#names(); if (!panel.open) return; }
    if (ask === "plots" && !this.chosen.length) { body.replaceChildren(this.#picker()); this.shown[ask] = text; return; }
    body.setAttribute("aria-busy", "true");
    if (!body.childElementCount) body.replaceChildren(element("p", "Working …", { class: "quiet" }));
    const more = ask === "plots" ? { names: this.chosen } : ask === "configurations" ? { pose: this.studio.canvas.pose } : {};
    const reply = await this.#reply(ask, more);
    if (!reply) return;
    body.removeAttribute("aria-busy");
    this.shown[ask] = text;
    const problems = (reply.problems ?? []).map(({ what, remedy }) => element("p", remedy ? `${what}: ${remedy}` : what, { class: "remedy" }));
    const made = problems.length ? [] : this[`show_${ask}`](reply);
    body.replaceChildren(...(ask === "plots" ? [this.#picker()] : []), ...problems, ...made);
  }

  async #names() {
    const reply = await this.#reply("results");
    if (!reply?.quantities) return;
    this.words = reply.quantities;
    if (!this.chosen.length) this.chosen = reply.outputs.slice(0, 1);
  }

  // what is plotted, each a button that takes it out, and a field for one more
  #picker() {
    const known = element("datalist", "", { id: "quantities" }, ...(this.words ?? []).map((one) => element("option", "", { value: one })));
    const field = element("input", "", { id: "quantity", list: "quantities", autocomplete: "off", placeholder: this.words?.[0] ?? "" });
    const again = () => { delete this.shown.plots; this.#ask("plots"); };
    field.addEventListener("change", () => {
      const name = field.value.trim();
      if (name && !this.chosen.includes(name)) { this.chosen.push(name); again(); }
    });
    const taken = this.chosen.map((name) => {
      const button = element("button", `${name} ×`, { "aria-label": `Take out ${name}` });
      button.addEventListener("click", () => { this.chosen = this.chosen.filter((one) => one !== name); again(); });
      return button;
    });
    return element("div", "", { class: "picker" }, labelled("Quantity", field), known, ...taken);
  }

  show_plots({ picture }) {
    return [element("img", "", { src: picture, alt: `Plot of ${this.chosen.join(", ")}`, class: "plotted" })];
  }

  // each branch is a range of the driver, which takes the mechanism there when it is clicked
  show_circuits({ picture, html, branches, unit }) {
    const low = Math.min(...branches.map(({ range }) => range[0])), high = Math.max(...branches.map(({ range }) => range[1]));
    const told = (one) => `${Number(one.toPrecision(5))}${unit === "°" ? unit : ` ${unit}`}`, part = (one) => (100 * (one - low)) / (high - low || 1);
    const ranges = branches.map(({ number, circuit, name, range: [from, to], is_shown: isShown }) => {
      const bar = element("span", "", { class: "range" });
      const button = element("button", "", { class: "branch", "aria-pressed": String(isShown), title: name }, element("span", `Circuit ${circuit}, branch ${number}: ${told(from)} to ${told(to)}`), bar);
      // set by script, as the page's policy forbids styles that are written
      Object.assign(bar.style, { marginLeft: `${part(from)}%`, width: `${Math.max(1, part(to) - part(from))}%` });
      button.addEventListener("click", () => { this.studio.halt(); this.studio.edit({ do: "branch", number }); });
      return button;
    });
    return [element("div", "", { class: "branches", role: "group", "aria-label": "Branches: a click goes there" }, ...ranges),
      element("img", "", { src: picture, alt: "Circuits over the driver", class: "plotted" }), fragment(html)];
  }

  show_forces({ pictures, html }) {
    const words = ["Efforts of the drivers", "Forces in the pairs"];
    return [...pictures.map((src, k) => element("img", "", { src, alt: words[k], class: "plotted" })), fragment(html)];
  }

  show_configurations({ configurations, words }) {
    const all = configurations.map(({ name, picture, is_shown: isShown }) => {
      const button = element("button", "", { class: "thumbnail", "aria-pressed": String(isShown) },
        element("img", "", { src: picture, alt: "", class: "paper" }), element("span", name));
      button.addEventListener("click", () => { if (!isShown) this.studio.edit({ do: "configuration", name }); });
      return button;
    });
    return [element("p", words, { class: "quiet" }), element("div", "", { class: "thumbnails" }, ...all)];
  }

  show_results({ sections, verdict, quantities }) {
    this.words = quantities;
    return [...(verdict ? [element("p", verdict)] : []), ...sections.map(({ key, title, html }) =>
      element("details", "", { "data-section": key }, element("summary", title), fragment(html)))];
  }

  // --- on the canvas

  isOn(name) { return this.switches[name].getAttribute("aria-pressed") === "true"; }

  #toggle(name, button) {
    button.setAttribute("aria-pressed", String(!this.isOn(name)));
    if (name === "paths") this.studio.canvas.svg.classList.toggle("without-paths", !this.isOn("paths"));
    else if (this.isOn(name) && !this.overlay) this.#overlays();
    this.#draw();
  }

  async #overlays() {
    if (!this.isMoving) return;
    const reply = await this.#reply("overlays");
    if (!reply) return;
    this.overlay = reply.problems?.length ? null : reply;
    if (reply.problems?.length) this.studio.say(reply.problems[0].what);
    else if (this.isOn("forces") && !reply.forces) this.studio.say("Nothing acts on it: write units, masses and loads into the text");
    this.#draw();
  }

  #draw() {
    this.layer.replaceChildren();
    const { canvas } = this.studio, k = canvas.pose ?? this.studio.motion?.start;
    this.#missed(canvas);
    if (!this.overlay || !this.isMoving || k === undefined) return;
    if (this.isOn("velocities")) {
      for (const [letter, [vx, vy]] of Object.entries(this.overlay.velocities)) {
        const at = canvas.at(letter), v = [vx[k], vy[k]];
        if (at && !v.includes(null) && Math.hypot(...v) >= 1e-6) this.#arrow(at, v, "velocity", COLOUR.velocities);
      }
    }
    if (this.isOn("forces") && this.overlay.forces) this.#forces(this.overlay.forces, k);
    if (this.isOn("centres")) {
      for (const [links, [xs, ys]] of Object.entries(this.overlay.centres)) {
        if (xs[k] === null || ys[k] === null) continue;
        const at = canvas.screen([xs[k], ys[k]]), [wide, high] = canvas.size;
        if (at[0] < 0 || at[1] < 0 || at[0] > wide || at[1] > high) continue;
        const isPin = Object.keys(canvas.structure.points).map((one) => canvas.at(one)).some((one) => one && Math.hypot(one[0] - at[0], one[1] - at[1]) < 2);
        const dot = svgElement("circle", { cx: at[0], cy: at[1], r: DOT, class: "centre", fill: COLOUR.centres }, this.layer);
        svgElement("title", {}, dot).textContent = `Instant centre of ${links}`;
        if (!isPin) svgElement("text", { x: at[0] + 7, y: at[1] + 14, class: "centre-name" }, this.layer).textContent = links.split(", ").join("–");
      }
    }
  }

  // from a place of the screen, in parts of the longest; returns its tip
  #arrow(at, v, style, stroke) {
    const tip = [at[0] + LONGEST * v[0], at[1] - LONGEST * v[1]], turned = Math.atan2(-v[1], v[0]);
    const barb = (by) => `${tip[0] - 9 * Math.cos(turned + by)} ${tip[1] - 9 * Math.sin(turned + by)}`;
    this.#outlined(`M${at.join(" ")}L${tip.join(" ")}M${barb(0.4)}L${tip.join(" ")}L${barb(-0.4)}`, style, stroke);
    return tip;
  }

  // on paper, so that it is told from the bar that it lies on
  #outlined(d, style, stroke) {
    svgElement("path", { d, class: `${style} under` }, this.layer);
    svgElement("path", { d, class: style, stroke }, this.layer);
  }

  // what acts at a pose: arrows to one scale, arcs of moments to none, each with its name, left of its tip, and its words
  #forces({ arrows, arcs, greatest, unit }, k) {
    const { canvas } = this.studio, known = ({ at: [xs, ys] }) => xs[k] !== null && canvas.screen([xs[k], ys[k]]);
    const named = (text, words, [x, y]) => {
      const node = svgElement("text", { x, y, class: "force-name", "text-anchor": "middle" }, this.layer);
      node.textContent = text;
      svgElement("title", {}, node).textContent = words;
    };
    for (const one of arrows) {
      const at = known(one), v = [one.force[0][k], one.force[1][k]], long = Math.hypot(...v);
      if (!at || v.includes(null) || long < FAINT) continue;
      const tip = this.#arrow(at, v, "force", COLOUR[one.kind] ?? COLOUR.force), [c, s] = [v[0] / long, v[1] / long], away = 7 + 3 * one.name.length * Math.abs(s);
      named(one.name, `${one.words}: ${Number((long * greatest).toPrecision(4))} ${unit}`, [tip[0] - away * s, tip[1] - 11 * c + 4]);
    }
    for (const one of arcs) {
      const at = known(one), moment = one.moment[k];
      if (!at || moment === null || Math.abs(moment) < FAINT) continue;
      // counterclockwise is clockwise where y points downward
      const sense = Math.sign(moment), on = (angle, r = ROUND) => [at[0] + r * Math.cos(angle), at[1] - r * Math.sin(angle)];
      const [from, to] = [Math.PI / 4 - (sense * SWEEP) / 2, Math.PI / 4 + (sense * SWEEP) / 2], back = to - (sense * 9) / ROUND;
      this.#outlined(`M${on(from).join(" ")}A${ROUND} ${ROUND} 0 0 ${sense > 0 ? 0 : 1} ${on(to).join(" ")}M${on(back, ROUND + 5).join(" ")}L${on(to).join(" ")}L${on(back, ROUND - 5).join(" ")}`, "force", COLOUR[one.kind] ?? COLOUR.force);
      named(one.name, one.words, on(Math.PI / 4, ROUND + 14));
    }
  }

  // where it cannot be assembled: circles that do not meet
  #missed(canvas) {
    const gap = canvas.pose !== null && this.studio.motion?.gaps?.find((one) => one.from <= canvas.pose && canvas.pose <= one.to);
    for (const { point, radius } of gap?.circles ?? []) {
      const at = canvas.at(point);
      if (at) svgElement("circle", { cx: at[0], cy: at[1], r: radius * canvas.view.scale, class: "missed" }, this.layer);
    }
  }

  // --- files

  async dialogs() {
    const { forms, catalog } = await this.studio.wire.ask({ document: "", question: { ask: "forms" } });
    this.forms = forms ?? [];
    this.catalog = catalog ?? {};
  }

  async open() {
    if (!this.forms) await this.dialogs();
    const known = element("datalist", "", { id: "catalog" }, ...Object.entries(this.catalog).map(([name, title]) => element("option", title, { value: name })));
    const field = element("input", "", { id: "open-name", list: "catalog", autocomplete: "off", placeholder: "six-bar" });
    const file = element("input", "", { id: "open-file", type: "file" });
    const ask = async (question) => {
      const reply = await this.studio.wire.ask({ document: "", question: { ask: "open", ...question } });
      this.#opened(reply, question.name);
    };
    file.addEventListener("change", async () => {
      const [given] = file.files;
      if (!given) return;
      const bytes = new Uint8Array(await given.arrayBuffer());
      if (/\.(toml|json)$/i.test(given.name)) this.#opened({ text: new TextDecoder().decode(bytes), notes: [] }, given.name);
      else await ask({ name: given.name, content: btoa(Array.from(bytes, (one) => String.fromCharCode(one)).join("")) });
    });
    this.#dialog("Open", [
      element("p", "What is drawn now stays in the history: Undo brings it back.", { class: "quiet" }),
      labelled("A name of the catalog, lengths such as four-bar:60,20,50,40, or a link of another program", field), known,
      labelled("Or a file, of compoundkin or of another program", file),
    ], "Open", () => ask({ name: field.value }));
  }

  #opened({ text, notes, problems }, name) {
    if (problems?.length) { this.#said(problems.map(({ what, remedy }) => (remedy ? `${what}: ${remedy}` : what)).join("; ")); return; }
    this.dialog?.close();
    this.chosen = [];
    this.words = null;
    [this.studio.isFitted, this.studio.isOpened] = [false, true];
    this.studio.put(text);
    this.studio.say([`Opened ${name}`, ...(notes ?? [])].join("; "));
  }

  async exports() {
    if (!this.forms) await this.dialogs();
    const form = element("select", "", { id: "export-form" }, ...this.forms.map(({ name, title, suffix }) => element("option", `${name}: ${title} (${suffix})`, { value: name })));
    this.#dialog("Export", [labelled("As what", form)], "Download", async () => {
      this.#said("Working …");
      const stem = this.studio.stem, reply = await this.#reply("export", { to: form.value, name: stem });
      if (!reply) return;
      if (reply.problems?.length) { this.#said(reply.problems.map(({ where, what, remedy }) => [where, what, remedy].filter(Boolean).join(": ")).join("; ")); return; }
      offered(stem + reply.suffix, Uint8Array.from(atob(reply.content), (one) => one.charCodeAt(0)), "application/octet-stream");
      this.#said([`Wrote ${stem}${reply.suffix}`, ...reply.notes].join("; "));
    });
  }

  copy() {
    const { text, stem } = this.studio;
    offered(`${stem}${text.trimStart().startsWith("{") ? ".json" : ".toml"}`, text, "text/plain");
    this.studio.say("A copy is in the browser's downloads");
  }

  #dialog(title, inner, words, run) {
    this.dialog?.remove();
    const said = element("p", "", { class: "said", role: "status" }), go = element("button", words, { class: "go" });
    const close = element("button", "Close");
    const heading = element("h2", title, { id: "dialog-title" });
    const dialog = element("dialog", "", { "aria-labelledby": "dialog-title" }, heading, ...inner, said, element("div", "", { class: "bar" }, go, close));
    go.addEventListener("click", run);
    close.addEventListener("click", () => dialog.close());
    dialog.addEventListener("keydown", (event) => {
      event.stopPropagation();
      if (event.key === "Enter" && event.target.matches("input:not([type=file])")) run();
    });
    dialog.addEventListener("close", () => dialog.remove());
    Object.assign(this, { dialog, said });
    this.part("canvas").closest(".studio").append(dialog);
    dialog.showModal();
  }

  #said(text) { if (this.said) this.said.textContent = text; }
}
