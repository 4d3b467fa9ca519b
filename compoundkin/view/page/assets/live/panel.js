// The panel of dimensions beside the sketch: fields for lengths and angles of links, numbers of pairs, and drivers.
(() => {
  "use strict";
  const page = window.compoundkin;
  const COLOURS = 7; // of groups; the frame and driven links have their own
  const MANY = 60; // rows from which links are folded
  const COARSE = 10; // steps of PageUp, and of an arrow with Shift
  const BEGUN = /^\s*[+\-−]?\d*[.,]?\d*(e[+-]?\d*)?\s*$/i; // what may become a number yet
  const LOCK = "M5 7V5a3 3 0 0 1 6 0v2M3.5 7h9v6.5h-9z";
  const REST = 700; // milliseconds after the last arrow until it is one step of undo

  const make = (name, className, text, parent) => {
    const element = document.createElement(name);
    if (className) element.className = className;
    if (text) element.textContent = text;
    if (parent) parent.append(element);
    return element;
  };
  // as screen readers take numbers: a hyphen for minus, six digits
  const typed = (value) => page.written(value).replace("−", "-");

  // A number field with its label, its unit, what it was, and what is wrong or possible.
  class Field {
    constructor(panel, row, links, place) {
      Object.assign(this, { panel, row, shown: "" });
      const id = `dimension-${panel.fields.length}`;
      this.root = make("div", "dimension", "", place);
      if (links.length) this.root.dataset.links = links.join(",");
      const named = make("div", "named", "", this.root), label = make("label", "", "", named);
      label.htmlFor = id;
      make("span", "", row.label, label).ariaHidden = "true";
      make("span", "unseen", `${row.spoken} of ${row.owner}`, label);
      if (row.doc) label.title = row.doc;
      this.input = make("input", "", "", this.root);
      Object.assign(this.input, { id, type: "text", inputMode: row.positive ? "decimal" : "text", autocomplete: "off", spellcheck: false });
      this.input.setAttribute("role", "spinbutton");
      this.input.setAttribute("aria-describedby", `${id}-unit ${id}-was ${id}-more`);
      this.was = make("span", "was", "", named);
      this.was.id = `${id}-was`;
      make("span", "of", row.unit, this.root).id = `${id}-unit`;
      this.back = this.button(this.root);
      this.lock = row instanceof page.PointRow && (row.kind === "length" || row.isAngle) ? this.locking() : null;
      this.more = make("p", "more", "", this.root);
      this.more.id = `${id}-more`;
      this.listen();
    }
    button(place) {
      if (!this.row.original) return null;
      const back = make("button", "back", "↺", place);
      back.type = "button";
      back.title = "Back to the original value";
      back.setAttribute("aria-label", `Reset ${this.row.spoken} of ${this.row.owner}`);
      back.addEventListener("click", () => { this.input.focus(); this.apply(this.row.original(), true); });
      return back;
    }
    // a length or an angle that is locked stays what it is while points are dragged
    locking() {
      const { row, panel: { player } } = this;
      const lock = make("button", "lock", "", this.root);
      Object.assign(lock, { type: "button", title: "Keep it while points are dragged" });
      lock.setAttribute("aria-label", `Lock ${row.spoken} of ${row.owner}`);
      lock.setAttribute("aria-pressed", "false");
      page.drawn("path", { d: LOCK }, page.drawn("svg", { viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" }, lock));
      lock.addEventListener("click", () => {
        const isLocked = lock.getAttribute("aria-pressed") !== "true";
        lock.setAttribute("aria-pressed", String(isLocked));
        this.input.readOnly = isLocked;
        this.root.classList.toggle("locked", isLocked);
        player.locks[isLocked ? "add" : "delete"](row);
      });
      return lock;
    }
    listen() {
      const { input } = this;
      input.addEventListener("input", () => { this.wrong(BEGUN.test(input.value) ? "" : this.row.wrong(input.value)); });
      input.addEventListener("change", () => this.taken());
      input.addEventListener("focus", () => { input.select(); this.focused(); });
      input.addEventListener("blur", () => { this.forget(); this.panel.rest(); if (!this.bad) this.say(""); });
      input.addEventListener("keydown", (event) => this.key(event));
    }
    key(event) {
      const { history } = this.panel.player, by = { ArrowUp: 1, ArrowDown: -1, PageUp: COARSE, PageDown: -COARSE }[event.key];
      // a number that was taken is undone as what was dragged is, one that is being typed as text is
      if (history && !this.bad && this.input.value === this.shown) history.way(event);
      if (event.key === "Enter") this.taken();
      else if (event.key === "Escape" && (this.bad || this.input.value !== this.shown)) {
        this.write();
        this.wrong("");
      } else if (by && this.input.readOnly) return;
      else if (by) this.stepped(by * (event.shiftKey && Math.abs(by) === 1 ? COARSE : 1));
      else return;
      event.preventDefault();
      if (event.key === "Escape") event.stopPropagation();
    }
    // an arrow steps from what is in the field, if that is a number
    stepped(by) {
      const { row } = this, text = this.input.value;
      const from = text !== this.shown && !row.wrong(text) ? row.value(text) : this.value;
      const to = Number((from + by * row.step).toPrecision(12));
      if (this.check(String(to))) this.apply(to, false);
    }
    taken() {
      const text = this.input.value;
      if (text === this.shown) return this.wrong("");
      if (this.check(text)) this.apply(this.row.value(text), true);
    }
    check(text) {
      this.wrong(this.row.wrong(text));
      return !this.bad;
    }
    wrong(text) {
      this.bad = text;
      this.input.setAttribute("aria-invalid", String(Boolean(text)));
      this.root.classList.toggle("wrong", Boolean(text));
      this.say(text);
    }
    say(text) {
      if (this.more.textContent === text) return;
      this.more.textContent = text;
      if (text) page.say(text);
    }
    apply(value, atOnce) {
      this.forget();
      this.panel.apply(this, value, atOnce);
      this.write();
      if (document.activeElement === this.input) this.focused();
    }

    // --- what it shows --------------------------------------------------------------------------------------------------
    get value() { return this.row.get(this.panel.now); }
    update() {
      const { row } = this, value = this.value, own = row.original ? row.original() : value;
      const changed = Boolean(row.original) && !row.isSame(value, own);
      const hides = row.late && !changed && document.activeElement !== this.input;
      // to write what is there already makes the browser look at the styles of the whole page
      if (this.root.hidden !== hides) this.root.hidden = hides;
      this.root.classList.toggle("changed", changed);
      this.was.textContent = changed ? `was ${page.written(own)}` : "";
      if (this.back && this.back.hidden === changed) this.back.hidden = !changed;
      // what somebody is typing, right or wrong, stays
      if (!this.bad && (document.activeElement !== this.input || this.input.value === this.shown)) this.write();
    }
    write() {
      const value = this.value, text = Number.isFinite(value) ? page.written(value) : "";
      if (text === this.shown && text === this.input.value) return;
      this.shown = this.input.value = text;
      if (Number.isFinite(value)) this.input.setAttribute("aria-valuenow", typed(value));
      else this.input.removeAttribute("aria-valuenow");
      this.input.setAttribute("aria-valuetext", page.withUnit(value, this.row.isAngle ? "deg" : this.row.unit));
    }

    // --- the range in which it assembles, while it is focused -----------------------------------------------------------
    focused() {
      if (this.row.told) return this.say(this.row.told());
      if (!this.bad) this.look();
    }
    look() {
      const { design } = this.panel;
      this.range = new page.AssembledRange(design, this.row, (range) => {
        const all = design.solved.assembled.every((one) => one === 1);
        if (!this.bad) this.say(`${all ? "Assembles at all poses" : "Poses that assemble now do so"} ${page.rangeTold(this.row, range)}.`);
      });
    }
    forget() {
      if (this.range) this.range.stop();
      this.range = null;
    }
  }

  class Panel {
    // locks are of the player: those who drag its points ask for them
    constructor(root, player) {
      const { live } = player.data;
      Object.assign(this, { root, player, design: player.design, fixed: live.panel.fixed, unit: player.data.unit, fields: [] });
      this.size = page.sizeOf(live.dimensions);
      player.locks = new Set();
      this.now = (name) => this.design.value(name);
      this.own = (name) => this.design.own[this.design.index.get(name)];
      this.build(live.panel);
      for (const kind of ["focusin", "focusout"]) {
        this.root.addEventListener(kind, ({ target }) => document.documentElement.classList.toggle("measuring", kind === "focusin" && Boolean(target.closest(".dimension"))), { signal: player.signal });
      }
      player.atEnd(() => {
        clearTimeout(this.resting);
        cancelAnimationFrame(this.waits);
        for (const field of this.fields) field.forget();
        this.root.querySelector(".dimensions").replaceChildren();
      });
      player.listeners.push(() => this.soon());
      for (const kind of ["change", "commit"]) this.design.on(kind, () => this.soon());
      this.update();
    }
    build({ links, pairs }) {
      const { player } = this, shown = ({ rows }) => rows.filter((row) => !row[2]).length;
      const groups = [
        ...links.map(({ name, rows }) => ({ name, rows, links: [name], Kind: page.PointRow, link: player.data.links.find((one) => one.name === name) })),
        ...pairs.map(({ name, rows, links: members }) => ({ name, rows, links: members, Kind: page.NumberRow })),
      ];
      const all = groups.reduce((sum, group) => sum + shown(group), 0);
      if (player.drivers.length) groups.unshift({ name: "Drivers", rows: player.drivers, links: [], Kind: page.DriverRow });
      // two columns about as high as each other, which stay as they are when rows come and go
      const height = (group) => (shown(group) ? 1 + (all > MANY ? 0 : shown(group)) : 0);
      const half = groups.reduce((sum, group) => sum + height(group), 0) / 2;
      const columns = [0, 1].map(() => make("div", "", "", this.root.querySelector(".dimensions")));
      let above = 0;
      for (const { name, rows, links: about, Kind, link } of groups) {
        const place = this.group(columns[above < half ? 0 : 1], name, link, Kind === page.DriverRow || all <= MANY);
        for (const row of rows) this.field(new Kind(this, name, row), about, place);
        above += height({ rows });
      }
    }
    group(place, name, link, open) {
      const group = make("details", "group", "", place), head = make("summary", "", "", group);
      group.open = open;
      if (link) {
        make("i", `swatch g${link.group ? ((link.group - 1) % COLOURS) + 1 : 0}`, "", head);
        make("b", "", String(link.number), head);
        head.dataset.links = name;
      }
      make("span", "", name, head);
      return group;
    }
    field(row, links, group) {
      if (!(row instanceof page.DriverRow)) row.original = () => row.get(this.own);
      this.fields.push(new Field(this, row, links, group));
    }

    // --- changes ----------------------------------------------------------------------------------------------------------
    apply({ row }, value, atOnce) {
      const { player, design } = this;
      if (row instanceof page.DriverRow) {
        player.transport.stop();
        return row.move(value);
      }
      if (atOnce) this.rest(); // what was stepped before it is a step of its own
      design.change(row.set(value, this.now));
      this.words = `${row.label} of ${row.owner}: ${page.written(value)} ${row.unit}`.trim();
      clearTimeout(this.resting);
      if (atOnce) this.rest();
      else this.resting = setTimeout(() => this.rest(), REST);
    }
    // what was stepped by arrows becomes one step of undo
    rest() {
      clearTimeout(this.resting);
      if (this.words) this.design.commit(this.words);
      this.words = "";
    }
    soon() {
      if (this.waits) return;
      this.waits = requestAnimationFrame(() => this.update());
    }
    update() {
      this.waits = 0;
      for (const field of this.fields) field.update();
      // classes for what :has() could tell: with it every change of a text makes the browser look at the styles of all links
      for (const group of this.root.querySelectorAll(".group")) {
        const isBare = !group.querySelector(".dimension:not([hidden])");
        if (group.hidden !== isBare) group.hidden = isBare;
        group.classList.toggle("altered", Boolean(group.querySelector(".dimension.changed")));
      }
      this.root.classList.toggle("changed", this.design.isChanged);
    }
  }

  // a document has one place for it: that of the player which it came with
  const root = document.getElementById("dimensions"), [player] = page.players;
  if (root && player?.design) player.panel = new Panel(root, player);
})();
