// One state machine for mouse, finger, pen and keyboard: what is pressed, what it would do, the edit that comes of it.
const FAR = 5, FINGER = 1.7, NEW_BAR = 90, LONG_PRESS = 550, ROUND = 15, ROUND_NEAR = 3, GRIP = 13, MOST_PHOTO = 2400;
const TOOLS = {
  draw: "Drag: a bar. Onto a point or a bar: joined there. With Shift: move points. Right click or long press: what can be done",
  move: "Drag a point or a bar; from the ground: a box chooses several. Right button or two fingers: the view. Wheel: nearer",
  cylinder: "Drag: a cylinder, from one bar or the ground to another bar",
  pen: "Draw a curve: closed where it ends at its beginning, else a stroke. Linkages that trace it come beside the canvas",
  photo: "Drag the photograph. V or Escape: done",
  measure: "Click a point of the photograph whose distance to another one you know",
};
const ordinal = (value) => Number(value.toPrecision(5));

export class Gestures {
  constructor(canvas, studio) {
    Object.assign(this, { canvas, studio, tool: "draw", held: null, typed: "", pointers: new Map() });
    const { svg } = canvas, on = (name, run, how) => svg.addEventListener(name, run, how);
    on("pointerdown", (event) => this.press(event));
    on("pointermove", (event) => this.move(event));
    on("pointerup", (event) => this.release(event));
    on("pointercancel", (event) => { this.pointers.delete(event.pointerId); this.stop(); });
    on("pointerleave", () => { if (!this.held) this.#look(null); });
    on("contextmenu", (event) => event.preventDefault());
    on("wheel", (event) => {
      event.preventDefault();
      canvas.zoom(Math.exp(-event.deltaY / 400), this.#at(event));
    }, { passive: false });
    on("dragover", (event) => event.preventDefault());
    on("drop", (event) => { event.preventDefault(); this.photograph(event.dataTransfer.files[0]); });
    this.#recall();
  }

  choose(tool) {
    this.tool = tool;
    this.first = null;
    this.#hint();
  }

  #at(event) {
    const box = this.canvas.svg.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  #told(long) { return [ordinal(long), this.studio.unit].filter((one) => one !== "").join(" "); }

  // --- the machine: pressed, moved, released

  press(event) {
    const at = this.#at(event), reach = event.pointerType === "mouse" ? 1 : FINGER;
    this.pointers.set(event.pointerId, at);
    this.closeMenu();
    if (this.held) {
      this.stop();
      // a second finger moves the view
      if (this.pointers.size === 2) this.held = { does: "pinch", isDragged: true };
      return;
    }
    this.canvas.svg.focus({ preventScroll: true });
    try { this.canvas.svg.setPointerCapture(event.pointerId); } catch { /* a pointer that is no more */ }
    this.studio.halt();
    this.typed = "";
    const under = this.canvas.under(at, reach);
    this.held = { ...this.#meaning(event, at, under), under, reach, start: at, last: at, isDragged: false, button: event.button };
    if (event.pointerType !== "mouse") this.held.timer = setTimeout(() => { this.stop(); this.menu(under, at); }, LONG_PRESS);
  }

  // what a press would do: one of the gestures below
  #meaning(event, at, under) {
    const { canvas, tool } = this, isMoving = (tool === "move") !== (event.shiftKey && tool !== "cylinder");
    const isNear = (grip) => grip && Math.hypot(at[0] - grip.at[0], at[1] - grip.at[1]) <= GRIP;
    if (event.button === 1 || event.button === 2) return { does: "pan" };
    if (tool === "measure" || tool === "photo" || tool === "pen") return { does: tool };
    if (isNear(canvas.drawn)) return { does: "lengthen", ...canvas.drawn };
    if (isNear(canvas.turned)) return { does: "turn", ...canvas.turned };
    if (under?.point && (event.ctrlKey || event.metaKey)) return { does: "lengthen", ...this.#lengthened(under.point) };
    if (tool === "cylinder") return { does: "cylinder" };
    if (under?.point && isMoving) {
      if (event.altKey) return { does: "tear" };
      const isHandle = under.point === canvas.handle && !event.shiftKey && !canvas.picked.has(under.point);
      return isHandle ? { does: "drive" } : { does: "move", letters: canvas.picked.has(under.point) ? [...canvas.picked] : [under.point] };
    }
    if (under?.link && isMoving) return { does: "move", letters: this.#carried(under.link) };
    if (!under && isMoving) return { does: "box" };
    return { does: "bar" };
  }

  // a bar that is dragged goes with its points, and with all that is chosen when one of them is
  #carried(name) {
    const own = this.canvas.link(name).points;
    return own.some((one) => this.canvas.picked.has(one)) ? [...new Set([...this.canvas.picked, ...own])] : own;
  }

  // the bar that grows when its end is dragged with Ctrl: the chosen one, else the one that turns about a fixed point
  #lengthened(letter) {
    const { canvas } = this, fixed = canvas.frame;
    const links = canvas.structure.links.filter((one) => one.name !== "frame" && one.points.length > 1 && one.points.includes(letter));
    const link = links.find((one) => one.name === canvas.chosen?.link) ?? links.find((one) => one.points.some((own) => own !== letter && fixed.includes(own))) ?? links[0];
    const from = link?.points.find((one) => one !== letter && fixed.includes(one)) ?? link?.points.find((one) => one !== letter);
    return { link: link?.name, letter, from };
  }

  move(event) {
    const at = this.#at(event), { held, canvas } = this;
    const before = new Map(this.pointers);
    if (this.pointers.has(event.pointerId)) this.pointers.set(event.pointerId, at);
    this.pointer = at;
    if (!held) { this.#look(canvas.under(at)); return; }
    if (held.does === "pinch") { this.#pinch(before); return; }
    if (!held.isDragged && Math.hypot(at[0] - held.start[0], at[1] - held.start[1]) < FAR) return;
    clearTimeout(held.timer);
    if (held.does === "pen" && !held.isDragged) this.studio.pen.begin(held.start);
    held.isDragged = true;
    held.isFree = held.does !== "lengthen" && (event.ctrlKey || event.metaKey);
    this.#drag(at);
    held.last = at;
  }

  #drag(at) {
    const { held, canvas } = this;
    if (held.does === "pan") canvas.pan([at[0] - held.last[0], at[1] - held.last[1]]);
    else if (held.does === "photo" && canvas.photo) this.#carry([at[0] - held.last[0], at[1] - held.last[1]]);
    else if (held.does === "drive") this.studio.drive(held.under.point, canvas.plane(at));
    else if (held.does === "move") this.#shift(at);
    else if (held.does === "tear") this.#tear(at);
    else if (held.does === "bar" || held.does === "cylinder") this.#stretch(at);
    else if (held.does === "lengthen") this.#grow(at);
    else if (held.does === "turn") this.#turn(at);
    else if (held.does === "box") canvas.sketch({ box: [held.start, at] });
    else if (held.does === "pen") this.studio.pen.follow(at);
  }

  #pinch(before) {
    const ends = [...this.pointers.keys()].slice(0, 2);
    if (ends.length < 2) return;
    const [[a, b], [c, d]] = [ends.map((one) => before.get(one)), ends.map((one) => this.pointers.get(one))];
    const gap = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]) || 1, middle = (p, q) => [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
    const [from, to] = [middle(a, b), middle(c, d)];
    this.canvas.pan([to[0] - from[0], to[1] - from[1]]);
    this.canvas.zoom(gap(c, d) / gap(a, b), to);
  }

  #snapped(at, how) {
    if (this.held.isFree) return { place: this.canvas.rounded(this.canvas.plane(at)), to: [] };
    return this.canvas.snapped(at, how);
  }

  #shift(at) {
    const { held, canvas, studio } = this, { letters, under } = held, letter = under?.point ?? letters[0];
    held.over = letters.length === 1 ? canvas.under(at, held.reach, letters) : null;
    if (!held.over?.point) held.over = null;
    const own = under?.point ? [] : letters, start = held.places ??= Object.fromEntries(letters.map((one) => [one, canvas.place(one)]));
    let snap = { place: canvas.rounded(canvas.plane(at)), to: [] };
    if (under?.point && !held.over) {
      const pivots = canvas.structure.links.filter((one) => one.name !== "frame" && one.points.includes(letter) && letters.length === 1)
        .flatMap((one) => one.points).filter((one) => one !== letter).map((one) => [canvas.place(one), one]);
      snap = this.#snapped(at, { letters, pivots });
    }
    const from = own.length ? canvas.plane(held.start) : start[letter];
    const to = own.length ? canvas.plane(at) : snap.place, by = [to[0] - from[0], to[1] - from[1]];
    held.to = Object.fromEntries(letters.map((one) => [one, own.length || letters.length > 1 ? canvas.rounded([start[one][0] + by[0], start[one][1] + by[1]]) : to]));
    const many = letters.length > 1 ? `${letters.length} points` : letter;
    if (canvas.locks.length && !held.over) studio.preview(this.#moveEdit());
    else canvas.moved = held.to;
    canvas.draw();
    canvas.sketch({ to: canvas.screen(to), ring: held.over && canvas.at(held.over.point), snaps: snap.to, words: snap.to.map((one) => one.words).join(", ") });
    studio.say(held.over ? `Let go: joins ${letter} to ${held.over.point}` : `Moves ${many}${this.#snapWords(snap)}; with Ctrl freely`);
  }

  #snapWords({ to }) { return to.length ? `: ${to.map((one) => one.words).join(", ")}` : ""; }

  // what an edit is told of locks: nothing where there are none
  get #locks() {
    const { locks } = this.canvas;
    return locks.length ? { locks } : {};
  }

  #moveEdit() {
    const entries = Object.entries(this.held.to);
    const what = entries.length > 1 ? { points: this.held.to } : { point: entries[0][0], to: entries[0][1] };
    return { do: "move", ...what, ...this.#locks };
  }

  #tear(at) {
    const { held, canvas } = this;
    held.snap = this.#snapped(at, { letters: [held.under.point] });
    canvas.sketch({ from: canvas.at(held.under.point), to: canvas.screen(held.snap.place) });
    this.studio.say(`Let go: takes a bar off ${held.under.point}`);
  }

  #stretch(at) {
    const { held, canvas, studio } = this, letter = held.under?.point;
    held.from ??= letter ? canvas.place(letter) : canvas.rounded(canvas.plane(held.start));
    held.over = canvas.under(at, held.reach, letter ? [letter] : []);
    if (held.over?.pair || (held.over?.link && held.over.link === held.under?.link)) held.over = null;
    const pivot = held.under?.link ? canvas.link(held.under.link).points.at(-1) : letter;
    const snap = held.over?.point ? { place: canvas.place(held.over.point), to: [] } : this.#snapped(at, { letters: [], pivots: [[held.from, pivot]] });
    held.snap = this.typed ? this.#typedEnd(canvas.plane(at)) ?? snap : snap;
    const [x, y] = held.from, [u, v] = held.snap.place, to = canvas.screen(held.snap.place);
    const long = ordinal(Math.hypot(u - x, v - y)), turned = ordinal((Math.atan2(v - y, u - x) * 180) / Math.PI);
    if (this.typed) held.over = null;
    canvas.sketch({ from: canvas.screen(held.from), to, ring: held.over ? to : null, snaps: held.snap.to, words: this.typed ? `${this.typed}_` : String(long) });
    const where = held.over?.point ? ` to ${held.over.point}` : held.over?.link ? ` onto ${held.over.link}` : "";
    const name = held.does === "bar" ? "bar" : "cylinder";
    studio.say(`A ${name} of ${this.#told(long)} at ${turned}°${where}${this.#snapWords(held.snap)}. Type a length, 45 or 45<30; with Ctrl freely`);
  }

  // the end that typed numbers mean: a length, and an angle after "<"
  #typedEnd(to) {
    const [long, turned] = this.typed.split("<").map(Number), [x, y] = this.held.from;
    if (!(long > 0)) return null;
    const angle = this.typed.includes("<") && Number.isFinite(turned) ? (turned * Math.PI) / 180 : Math.atan2(to[1] - y, to[0] - x);
    return { place: [x + long * Math.cos(angle), y + long * Math.sin(angle)], to: [], isTyped: true };
  }

  #grow(at) {
    const { held, canvas, studio } = this;
    if (!held.link) { studio.say("No bar ends here"); return; }
    held.from0 ??= canvas.place(held.from);
    held.to0 ??= canvas.place(held.letter);
    held.grab ??= canvas.plane(held.start);
    const [x, y] = held.from0, [u, v] = held.to0, long = Math.hypot(u - x, v - y), here = canvas.plane(at);
    const by = ((here[0] - held.grab[0]) * (u - x) + (here[1] - held.grab[1]) * (v - y)) / long;
    const digits = Math.max(0, -Math.floor(Math.log10(2 / canvas.view.scale)));
    held.length = this.typed ? Number(this.typed) : Number((long + by).toFixed(digits));
    const end = [x + ((u - x) * held.length) / long, y + ((v - y) * held.length) / long];
    if (held.length > 0) studio.preview(this.#lengthEdit());
    canvas.sketch({ from: canvas.screen(held.from0), to: canvas.screen(end), words: this.typed ? `${this.typed}_` : String(held.length) });
    studio.say(`Lengthens ${held.link} alone, from ${ordinal(long)} to ${this.#told(held.length)}; all other links keep their lengths`);
  }

  #lengthEdit() {
    const { link, letter, from, length } = this.held;
    return { do: "lengthen", link, point: letter, from, length, ...this.#locks };
  }

  #turn(at) {
    const { held, canvas, studio } = this, [x, y] = canvas.at(held.letter);
    let angle = (Math.atan2(y - at[1], at[0] - x) * 180) / Math.PI;
    const round = Math.round(angle / ROUND) * ROUND;
    if (!held.isFree && Math.abs(angle - round) <= ROUND_NEAR) angle = round;
    held.angle = ordinal(angle);
    canvas.sketch({ guide: { at: [x, y], angle: (held.angle * Math.PI) / 180 }, to: at, words: `${held.angle}°` });
    studio.say(`${held.letter} slides at ${held.angle}°`);
  }

  release(event) {
    const { held, canvas } = this, at = this.#at(event);
    this.pointers.delete(event.pointerId);
    if (held?.does === "pinch" && this.pointers.size) return;
    if (held?.isDragged && held.does !== "pinch") { held.last = at; this.#drop(at); }
    this.stop();
    if (held && !held.isDragged) this.#click(held, at, event);
    canvas.draw();
    this.#hint();
  }

  #click(held, at, event) {
    const { canvas } = this, { under } = held;
    if (held.button === 2) { this.menu(under, at); return; }
    if (held.does === "measure") { this.#measure(canvas.plane(at)); return; }
    if (held.does === "lengthen" || held.does === "turn") { this.#asked(held); return; }
    if (event.shiftKey && under?.point) {
      if (!canvas.picked.delete(under.point)) canvas.picked.add(under.point);
    } else if (held.does !== "pan") canvas.picked.clear();
    canvas.chosen = held.does === "pan" ? null : under;
  }

  #drop(at) {
    const { held, canvas, studio } = this;
    if (held.does === "move") {
      if (held.over) studio.edit({ do: "join", point: held.letters[0], with: held.over.point });
      else if (held.to) studio.edit(this.#moveEdit());
    } else if (held.does === "tear") {
      const letter = held.under.point, moving = studio.linksAt(letter).filter((one) => one !== "frame"), link = moving.includes(canvas.chosen?.link) ? canvas.chosen.link : moving.at(-1);
      if (link && held.snap) studio.edit({ do: "tear", point: letter, link, to: held.snap.place });
    } else if ((held.does === "bar" || held.does === "cylinder") && held.snap) {
      const end = (what, where) => (what?.point ? { point: what.point } : what?.link ? { link: what.link, at: where } : { at: where });
      studio.edit({ do: held.does, from: end(held.under, held.from), to: end(held.over, held.snap.place) });
    } else if (held.does === "lengthen" && held.length > 0) {
      studio.edit(this.#lengthEdit());
    } else if (held.does === "turn" && held.angle !== undefined) {
      studio.edit({ do: "turn", pair: held.pair, angle: held.angle });
    } else if (held.does === "box") {
      const [left, right] = [held.start[0], at[0]].sort((a, b) => a - b), [top, low] = [held.start[1], at[1]].sort((a, b) => a - b);
      canvas.picked = new Set(canvas.allLetters.filter((one) => { const [x, y] = canvas.at(one) ?? []; return x >= left && x <= right && y >= top && y <= low; }));
      canvas.chosen = null;
    } else if (held.does === "photo") this.#remember();
    else if (held.does === "pen") studio.pen.end();
  }

  stop() {
    clearTimeout(this.held?.timer);
    // a curve that is not drawn to its end is none
    const { pen } = this.studio;
    if (this.held?.does === "pen" && pen.places.length && !pen.isDone) pen.clear();
    this.held = null;
    this.typed = "";
    this.canvas.moved = {};
    this.canvas.sketch();
    this.canvas.draw();
  }

  // --- keys that belong to a gesture: numbers that are typed while it lasts, or for the bar that is chosen

  key(event) {
    const { held, canvas } = this, { key } = event;
    const isDrawing = held?.isDragged && ["bar", "cylinder", "lengthen"].includes(held.does);
    if (!isDrawing && (held || !canvas.chosen?.link)) return false;
    if (/^[0-9.,<-]$/.test(key) || (key === "Backspace" && this.typed)) {
      this.typed = key === "Backspace" ? this.typed.slice(0, -1) : this.typed + (key === "," ? "." : key);
      if (isDrawing) this.#drag(held.last);
      else this.studio.say(`Length of ${canvas.chosen.link}: ${this.typed}_ Enter: that long, and no other link changes`);
      return true;
    }
    if (key !== "Enter" || !this.typed) return false;
    if (isDrawing) { this.#drop(held.last); this.stop(); } else {
      const length = Number(this.typed), grip = canvas.drawn;
      this.typed = "";
      if (grip) this.studio.edit({ do: "lengthen", link: grip.link, point: grip.letter, from: grip.from, length, ...this.#locks });
    }
    return true;
  }

  #look(over) {
    const { canvas } = this;
    if (over?.point === canvas.over?.point && over?.link === canvas.over?.link && over?.pair === canvas.over?.pair) return;
    canvas.over = over;
    canvas.draw();
    this.#hint();
  }

  // what a click or a drag would do here
  #hint() {
    const { over, chosen, picked } = this.canvas, it = over ?? chosen, isMoving = this.tool === "move";
    const draws = this.tool === "cylinder" ? "drag for a cylinder" : "drag for a bar";
    let what = TOOLS[this.tool];
    if (this.tool === "pen") { this.studio.say(what); return; }
    if (this.tool === "measure" || this.tool === "photo") { this.studio.say(this.first ? "Click the other point" : what); return; }
    if (picked.size && !over) what = `${[...picked].join(", ")} chosen: drag one of them, arrows move them, Delete deletes them`;
    else if (it?.point) what = `${it.point}: ${isMoving ? "drag to move it, onto a point to join, with Alt to take a bar off" : draws}, with Ctrl to lengthen one bar alone; G ground, D driver, S slide, Delete; right click: all`;
    else if (it?.link) what = `${it.link}: ${isMoving ? "drag to move it" : `${draws}; a bar dropped on it gets a pin there`}; click to choose it, then type a length; P a pin here, Delete; right click: all`;
    else if (it?.pair) what = `${it.pair}: ${this.canvas.cylinder(it.pair) ? "D drives it, " : "click to choose it, "}Delete; right click: all`;
    this.studio.say(what);
  }

  // the point or link that keys and buttons mean: what is under the pointer, else what is chosen
  get meant() { return this.canvas.over ?? this.canvas.chosen ?? null; }

  act(what) {
    const { studio, canvas } = this, it = what === "delete" ? canvas.chosen ?? canvas.over : this.meant;
    if (what === "delete" && canvas.picked.size) {
      const edits = [...canvas.picked].map((point) => ({ do: "delete", point }));
      canvas.picked.clear();
      studio.edit({ do: "all", edits });
      return;
    }
    if (what === "gear" || what === "cam") { this.#pairOf(what); return; }
    // on the empty ground G makes a fixed point, such as the axis of a cam
    if (!it && what === "ground" && this.pointer) { studio.edit({ do: "point", link: "frame", at: canvas.snapped(this.pointer).place }); return; }
    if (!it) { studio.say("Choose a point or a bar first: click it"); return; }
    if (what === "point") {
      const here = this.pointer && canvas.chosen?.link ? canvas.linksUnder(this.pointer) : [];
      if (here.length > 1) studio.edit({ do: "point", links: here.slice(0, 2), at: canvas.snapped(this.pointer).place });
      else if (canvas.chosen?.link && this.pointer) studio.edit({ do: "point", link: canvas.chosen.link, at: canvas.rounded(canvas.plane(this.pointer)) });
      else studio.say("Choose a bar first: click it");
    } else if (what === "delete") {
      canvas.chosen = canvas.over = null;
      studio.edit({ do: "delete", ...it });
    } else if (it.pair) {
      const isDriven = studio.structure.drives.some((one) => one.name === it.pair);
      if (what !== "driver" || !canvas.cylinder(it.pair)) studio.say(`${it.pair}: Delete, or the menu`);
      else studio.edit(isDriven ? { do: "delete", drive: it.pair } : { do: "driver", cylinder: it.pair });
    } else if (what === "slide" && it.link && canvas.chosen?.point) {
      studio.edit({ do: "slide", point: canvas.chosen.point, on: it.link });
    } else if (what === "lock") {
      this.lock(it.point ? "point" : "length", it.point ? [it.point] : canvas.link(it.link).points.slice(0, 2));
    } else if (!it.point) {
      studio.say(`Choose a point of ${it.link}: click it`);
    } else if (what === "trace") {
      if (!canvas.toggled.delete(it.point)) canvas.toggled.add(it.point);
      this.#remember();
      canvas.draw();
    } else if (what === "driver") {
      const drive = studio.driveAt(it.point);
      studio.edit(drive ? { do: "delete", drive } : { do: "driver", point: it.point });
    } else if (what === "slide") {
      const pair = studio.slideAt(it.point);
      studio.edit(pair ? { do: "delete", pair } : { do: "slide", point: it.point });
    } else {
      studio.edit({ do: what, point: it.point });
    }
  }

  // the chosen points by the keyboard: moved by arrows, a bar from the chosen one
  nudge(by) {
    const { canvas, studio } = this, letters = canvas.picked.size ? [...canvas.picked] : [canvas.chosen?.point].filter(Boolean);
    if (!letters.length || letters.some((one) => !canvas.at(one))) return;
    const moved = (letter) => { const [x, y] = canvas.at(letter); return canvas.rounded(canvas.plane([x + by[0], y + by[1]])); };
    this.held = { to: Object.fromEntries(letters.map((one) => [one, moved(one)])) };
    studio.edit(this.#moveEdit());
    this.held = null;
  }

  bar() {
    const { canvas, studio } = this, letter = canvas.chosen?.point;
    const [x, y] = (letter && canvas.at(letter)) || canvas.size.map((one) => one / 2);
    const from = letter ? { point: letter } : { at: canvas.rounded(canvas.plane([x, y])) };
    studio.edit({ do: "bar", from, to: { at: canvas.rounded(canvas.plane([x + NEW_BAR, y - NEW_BAR / 2])) } });
  }

  pickAll() {
    this.canvas.picked = new Set(this.canvas.allLetters);
    this.canvas.draw();
    this.#hint();
  }

  // --- locks: lengths, directions and points that stay while others are moved

  #locked(what, points) {
    return this.canvas.locks.findIndex((one) => one.what === what && one.points.length === points.length && one.points.every((letter) => points.includes(letter)));
  }

  lock(what, points) {
    const { locks } = this.canvas, k = this.#locked(what, points);
    if (k >= 0) locks.splice(k, 1);
    else locks.push({ what, points });
    this.#remember();
    this.canvas.draw();
    const named = what === "point" ? points[0] : `${what === "length" ? "the length" : "the direction"} ${points.join("")}`;
    this.studio.say(k >= 0 ? `Unlocked: ${named}` : `Locked: ${named} stays while points are moved`);
  }

  // --- the menu of what can be done here, each that cannot with its reason

  async menu(it, at) {
    const { canvas, studio } = this, place = canvas.rounded(canvas.plane(at)), before = canvas.chosen;
    if (it) { canvas.chosen = it; canvas.draw(); }
    const items = it?.point ? this.#ofPoint(it.point, before) : it?.link ? this.#ofLink(it.link, at, place, before) : it?.pair ? this.#ofPair(it.pair) : this.#ofGround(at);
    const asked = items.filter((one) => one.edit), text = studio.text;
    const { why = [] } = asked.length ? await studio.ask({ ask: "offers", edits: asked.map((one) => one.edit) }) : {};
    if (text !== studio.text) return;
    asked.forEach((one, k) => { one.why ||= why[k]; });
    this.#open(items, at);
  }

  #ofPoint(letter, before) {
    const { canvas, studio } = this, links = studio.linksAt(letter), bars = links.filter((one) => one !== "frame" && canvas.link(one).points.length > 1);
    const drive = studio.driveAt(letter), slide = studio.slideAt(letter), isFixed = links.includes("frame");
    const others = (canvas.structure?.links ?? []).filter((one) => !links.includes(one.name) && one.name !== "frame" && one.points.length > 1).map((one) => one.name);
    if (others.includes(before?.link)) others.unshift(...others.splice(others.indexOf(before.link), 1));
    const other = [...canvas.picked, before?.point].find((one) => one && one !== letter), none = "click the other point first, then open this menu";
    const lock = this.#locked("point", [letter]) >= 0;
    return [
      { words: isFixed ? `Let ${letter} go` : `Ground ${letter}`, key: "G", edit: { do: "ground", point: letter } },
      drive ? { words: "Take the driver out", key: "D", edit: { do: "delete", drive } } : { words: `Drive ${letter}`, key: "D", edit: { do: "driver", point: letter } },
      ...(slide
        ? [{ words: "Take the slide out", key: "S", edit: { do: "delete", pair: slide } }, { words: "Turn the slide…", edit: { do: "turn", pair: slide, angle: 0 }, run: () => this.#asked({ does: "turn", pair: slide, letter }) }]
        : [{ words: "Slide here", key: "S", edit: { do: "slide", point: letter } }, { words: "Slide here, upright", edit: { do: "slide", point: letter, angle: 90 } }]),
      ...(others.length ? others.slice(0, 3).map((one) => ({ words: `Slot for ${letter} along ${one}`, edit: { do: "slide", point: letter, on: one } })) : [{ words: "Slot along a bar", why: "there is no other bar" }]),
      ...(bars.length > 1 ? bars.slice(1, 3).map((one) => ({ words: `Weld ${bars[0]} and ${one}`, key: "W", edit: { do: "weld", point: letter, link: bars[0], with: one } })) : [{ words: "Weld", key: "W", edit: { do: "weld", point: letter } }]),
      ...(links.length > 1 ? bars.slice(0, 3).map((one) => ({ words: `Take ${one} off`, edit: { do: "tear", point: letter, link: one } })) : []),
      slide && other
        ? { words: `Rack here, its pinion at ${other}`, key: "R", edit: { do: "rack", point: other, with: letter } }
        : { words: `Gears or a belt at ${other ?? "…"} and ${letter}…`, key: "R", why: other ? "" : none, run: () => this.#gears(other, letter) },
      { words: `Cam at ${other ?? "…"} that leads ${letter}…`, key: "K", why: other ? "" : none, run: () => this.#cam(other, letter) },
      { words: canvas.isTraced(letter) ? `No path of ${letter}` : `Trace ${letter}`, key: "T", why: studio.motion?.poses ? "" : "it does not move yet", run: () => this.act("trace") },
      { words: lock ? "Unlock it" : "Lock it here", key: "L", run: () => this.lock("point", [letter]) },
      { words: `Delete ${letter}`, key: "Delete", edit: { do: "delete", point: letter } },
    ];
  }

  #ofLink(name, at, place, before) {
    const { canvas, studio } = this, { points } = canvas.link(name), here = canvas.linksUnder(at).slice(0, 2);
    const fixed = points.find((one) => canvas.frame.includes(one)) ?? points.find((one) => studio.linksAt(one).length > 1) ?? points[0];
    const drive = studio.structure.drives.find((one) => one.link === name)?.name, ends = points.slice(0, 2), point = before?.point;
    const locked = (what) => this.#locked(what, ends) >= 0;
    const shared = points.flatMap((letter) => studio.linksAt(letter).filter((one) => one !== name && one !== "frame" && canvas.link(one).points.length > 1).map((other) => [letter, other]));
    return [
      { words: here.length > 1 ? `Pin ${here.join(" and ")} here` : "A pin here", key: "P", edit: here.length > 1 ? { do: "point", links: here, at: place } : { do: "point", link: name, at: place } },
      { words: `Slot for ${point ?? "…"} along ${name}`, key: "S", ...(point ? { edit: { do: "slide", point, on: name } } : { why: "click the point that shall slide first" }) },
      drive ? { words: "Take its driver out", key: "D", edit: { do: "delete", drive } } : { words: `Drive ${name} at ${fixed}`, key: "D", edit: { do: "driver", point: fixed, link: name } },
      { words: "Length…", why: canvas.drawn ? "" : "it has one point", run: () => this.#asked({ does: "lengthen", ...canvas.drawn }) },
      { words: locked("length") ? "Unlock its length" : "Lock its length", key: "L", run: () => this.lock("length", ends) },
      { words: locked("angle") ? "Unlock its direction" : "Lock its direction", run: () => this.lock("angle", ends) },
      ...(shared.length ? shared.slice(0, 2).map(([letter, other]) => ({ words: `Weld to ${other} at ${letter}`, edit: { do: "weld", point: letter, link: name, with: other } })) : [{ words: "Weld", why: `no other bar is joined to ${name}` }]),
      { words: `Delete ${name}`, key: "Delete", edit: { do: "delete", link: name } },
    ];
  }

  #ofPair(name) {
    const isDriven = this.studio.structure.drives.some((one) => one.name === name);
    if (!this.canvas.cylinder(name)) return [{ words: `Delete ${name}`, key: "Delete", edit: { do: "delete", pair: name } }];
    return [
      isDriven ? { words: "Take its driver out", key: "D", edit: { do: "delete", drive: name } } : { words: `Drive ${name}`, key: "D", edit: { do: "driver", cylinder: name } },
      { words: `Delete ${name}`, key: "Delete", edit: { do: "delete", pair: name } },
    ];
  }

  #ofGround(at) {
    const { canvas } = this, { photo } = canvas, why = photo ? "" : "there is no photograph", place = canvas.rounded(canvas.plane(at));
    const shade = (by) => () => { photo.opacity = Math.min(1, Math.max(0.1, photo.opacity + by)); this.#remember(); canvas.draw(); };
    return [
      { words: "A fixed point here", key: "G", edit: { do: "point", link: "frame", at: place } },
      { words: "Choose all", key: "Ctrl+A", why: canvas.allLetters.length ? "" : "there is nothing", run: () => this.pickAll() },
      { words: "All of it in view", key: "F", run: () => canvas.fit() },
      { words: "A photograph beneath…", run: () => this.studio.part("photo").click() },
      { words: "Scale the photograph by two points", why, run: () => this.choose("measure") },
      { words: "Move the photograph", why, run: () => this.choose("photo") },
      { words: "Photograph fainter", why, run: shade(-0.2) },
      { words: "Photograph stronger", why, run: shade(0.2) },
      { words: "Take the photograph away", why, run: () => { canvas.photo = null; this.#remember(); canvas.draw(); } },
      { words: "Unlock all", why: canvas.locks.length ? "" : "nothing is locked", run: () => { canvas.locks = []; this.#remember(); canvas.draw(); } },
    ];
  }

  #open(items, at) {
    this.closeMenu();
    const box = document.createElement("div"), { svg } = this.canvas, around = svg.getBoundingClientRect();
    box.className = "menu";
    box.setAttribute("role", "menu");
    box.setAttribute("aria-label", "What can be done here");
    for (const { words, key, why, edit, run } of items) {
      const button = document.createElement("button");
      button.setAttribute("role", "menuitem");
      button.append(words);
      if (key && !why) { const note = document.createElement("kbd"); note.textContent = key; button.append(note); }
      if (why) {
        button.setAttribute("aria-disabled", "true");
        const note = document.createElement("small");
        note.textContent = why;
        button.append(note);
      }
      button.addEventListener("click", () => {
        if (why) { this.studio.say(`${words}: ${why}`); return; }
        this.closeMenu();
        if (run) run();
        else this.studio.edit(edit);
      });
      box.append(button);
    }
    box.addEventListener("keydown", (event) => {
      const all = [...box.children], k = all.indexOf(this.studio.focused);
      const to = { ArrowDown: k + 1, ArrowUp: k - 1 + all.length, Home: 0, End: all.length - 1 }[event.key];
      if (event.key === "Escape") this.closeMenu();
      else if (event.key === "Tab") this.closeMenu();
      else if (to === undefined) { event.stopPropagation(); return; }
      else all[to % all.length].focus();
      event.preventDefault();
      event.stopPropagation();
    });
    // a region of its own, as it belongs to none of the page's
    const region = document.createElement("section");
    region.setAttribute("aria-label", "Menu");
    region.append(box);
    this.studio.root.append(region);
    box.style.left = `${Math.max(4, Math.min(around.left + at[0], innerWidth - box.offsetWidth - 4))}px`;
    box.style.top = `${Math.max(4, Math.min(around.top + at[1], innerHeight - box.offsetHeight - 4))}px`;
    this.opened = box;
    box.firstChild?.focus({ preventScroll: true });
    // in a shadow root the target is its host
    this.#away = (event) => { if (!event.composedPath().includes(box)) this.closeMenu(); };
    document.addEventListener("pointerdown", this.#away, true);
  }

  #away = null;

  closeMenu() {
    if (!this.opened) return;
    document.removeEventListener("pointerdown", this.#away, true);
    const hadFocus = this.opened.contains(this.studio.focused);
    this.opened.parentElement.remove();
    this.opened = null;
    if (hadFocus) this.canvas.svg.focus({ preventScroll: true });
  }

  // where the menu of the keyboard opens: at what is chosen
  menuOfKey() {
    const { canvas } = this, it = canvas.chosen, middle = canvas.size.map((one) => one / 2);
    const letters = it?.point ? [it.point] : canvas.link(it?.link)?.points ?? canvas.cylinder(it?.pair)?.points ?? [];
    const places = letters.map((one) => canvas.at(one)).filter(Boolean).slice(0, 2);
    const at = places.length ? [0, 1].map((k) => places.reduce((sum, one) => sum + one[k], 0) / places.length) : middle;
    this.menu(it, at);
  }

  // --- small forms

  // each field: its name, its words, its value; a list of values is chosen from
  #form(title, fields, then) {
    const box = document.createElement("dialog"), form = document.createElement("form"), head = document.createElement("h2");
    box.className = "form";
    box.setAttribute("aria-label", title);
    head.textContent = title;
    form.method = "dialog";
    form.append(head);
    const inputs = {};
    for (const [name, words, value] of fields) {
      const label = document.createElement("label"), input = document.createElement(Array.isArray(value) ? "select" : "input");
      if (Array.isArray(value)) for (const [one, said] of value) input.append(new Option(said, one));
      else if (typeof value === "boolean") Object.assign(input, { type: "checkbox", checked: value });
      else Object.assign(input, { type: "number", step: "any", value: ordinal(value), required: true });
      label.append(words, input);
      inputs[name] = input;
      form.append(label);
    }
    const bar = document.createElement("div"), go = document.createElement("button"), leave = document.createElement("button");
    bar.className = "bar";
    go.textContent = "Do it";
    leave.textContent = "Cancel";
    leave.type = "button";
    leave.addEventListener("click", () => box.close());
    bar.append(go, leave);
    form.append(bar);
    form.addEventListener("submit", () => then(Object.fromEntries(Object.entries(inputs).map(([name, input]) => [name, input.type === "checkbox" ? input.checked : input.type === "number" ? Number(input.value) : input.value]))));
    box.addEventListener("keydown", (event) => event.stopPropagation());
    box.addEventListener("close", () => box.remove());
    box.append(form);
    this.studio.root.append(box);
    box.showModal();
    Object.values(inputs)[0].select?.();
  }

  // the unit of all lengths: the one that is written first, then none and those that are known
  unit() {
    const own = this.studio.unit, known = ["", ...(this.studio.structure?.units ?? [])].filter((one) => one !== own);
    this.#form("Unit of all lengths; numbers stay", [["unit", "Lengths are in", [own, ...known].map((one) => [one, one || "no unit"])]], ({ unit }) => {
      if (unit !== own) this.studio.edit({ do: "unit", unit });
    });
  }

  #asked({ does, link, letter, from, pair }) {
    const { canvas, studio } = this;
    if (does === "turn") {
      const angle = ((canvas.turned?.angle ?? 0) * 180) / Math.PI;
      this.#form(`Direction of the slide at ${letter}`, [["angle", "Degrees", angle]], (given) => studio.edit({ do: "turn", pair, ...given }));
    } else if (link) {
      const [a, b] = [canvas.place(from), canvas.place(letter)];
      this.#form(`Length of ${link}`, [["length", `${from}${letter} in ${studio.unit || "units"}`, Math.hypot(b[0] - a[0], b[1] - a[1])]], ({ length }) => studio.edit({ do: "lengthen", link, point: letter, from, length, ...(canvas.locks.length ? { locks: canvas.locks } : {}) }));
    }
  }

  // gears and cams have two points: those that are chosen with Shift, or the chosen one and the one under the pointer
  #pairOf(what) {
    const { canvas, studio } = this, letters = [...new Set([...canvas.picked, canvas.chosen?.point, canvas.over?.point].filter(Boolean))];
    if (letters.length < 2) { studio.say(what === "gear" ? "Click one axis, point at the other, press R; or choose both with Shift" : "Click the cam's axis, point at the point that it leads, press K; or choose both with Shift"); return; }
    const rack = letters.slice(0, 2).find((one) => studio.slideAt(one));
    if (what === "gear" && rack) studio.edit({ do: "rack", point: letters.find((one) => one !== rack), with: rack });
    else if (what === "gear") this.#gears(letters[0], letters[1]);
    else this.#cam(letters[0], letters[1]);
  }

  #gears(one, two) {
    const { studio, canvas } = this, at = (letter) => [["", "a wheel of its own"], ...studio.linksAt(letter).filter((name) => name !== "frame" && canvas.link(name).points.length > 1).map((name) => [name, name])];
    const kinds = [["gear", "gears"], ["ring", `gears, the one at ${two} a ring`], ["belt", "a belt or a chain"], ["crossed", "a crossed belt"]];
    this.#form(`Gears or a belt at ${one} and ${two}`, [["kind", "They are", kinds], ["a", `Teeth at ${one} (of a belt: radius)`, 20], ["b", `Teeth at ${two} (of a belt: radius)`, 40], ["first", `On, at ${one}`, at(one)], ["second", `On, at ${two}`, at(two)]],
      ({ kind, a, b, ...on }) => studio.edit(kind === "belt" || kind === "crossed"
        ? { do: "belt", point: one, with: two, radii: [a, b], crossed: kind === "crossed", ...on }
        : { do: "gear", point: one, with: two, teeth: [a, b], internal: kind === "ring", ...on }));
  }

  #cam(axis, letter) {
    const { studio, canvas } = this, [a, b] = [canvas.place(axis), canvas.place(letter)], gap = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const swings = !studio.slideAt(letter);
    this.#form(`Cam at ${axis} that leads ${letter}`, [["kind", "Cam", [["made", "for a rise and a return"], ["disc", "a round disc off its middle"]]], ["radius", "Base circle", gap * 0.8], ["roller", "Roller (0: an edge)", gap * 0.2], ["rise", swings ? "Rise (degrees; of a disc: its throw)" : "Rise", swings ? 20 : gap * 0.4], ["over", "Rises over, degrees", 120], ["dwell", "then rests for", 60], ["back", "returns over", 120]],
      (given) => studio.edit({ do: "cam", point: axis, with: letter, ...given }));
  }

  // --- the photograph beneath: read here, kept in this browser, sent nowhere

  async photograph(file) {
    if (!file?.type.startsWith("image/")) { this.studio.say("That is no picture"); return; }
    const href = await new Promise((resolve) => { const reader = new FileReader(); reader.onload = () => resolve(reader.result); reader.readAsDataURL(file); });
    const image = new Image();
    image.src = href;
    try { await image.decode(); } catch { this.studio.say("That picture cannot be read"); return; }
    const by = Math.min(1, MOST_PHOTO / Math.max(image.naturalWidth, image.naturalHeight));
    const [wide, high] = [image.naturalWidth, image.naturalHeight].map((one) => Math.max(1, Math.round(one * by)));
    const sheet = Object.assign(document.createElement("canvas"), { width: wide, height: high });
    sheet.getContext("2d").drawImage(image, 0, 0, wide, high);
    const { canvas } = this, [across, down] = canvas.size, scale = 0.8 * Math.min(across / wide, down / high) / canvas.view.scale;
    const [x, y] = canvas.plane([across / 2, down / 2]);
    canvas.photo = { href: by < 1 ? sheet.toDataURL("image/jpeg", 0.85) : href, wide, high, scale, x: x - (wide * scale) / 2, y: y + (high * scale) / 2, opacity: 0.5 };
    canvas.draw();
    await this.#remember();
    this.choose("measure");
  }

  #carry([x, y]) {
    const { photo, view } = this.canvas;
    photo.x += x / view.scale;
    photo.y -= y / view.scale;
    this.canvas.draw();
  }

  #measure(place) {
    const { canvas, studio } = this, { photo } = canvas;
    if (!photo) { this.choose("move"); return; }
    if (!this.first) { this.first = place; canvas.sketch({ ring: canvas.screen(place) }); this.#hint(); return; }
    const [x, y] = this.first, now = Math.hypot(place[0] - x, place[1] - y);
    this.first = null;
    if (!now) { this.#hint(); return; }
    this.#form("How far are they apart?", [["far", `In ${studio.unit || "the drawing's unit"}`, now]], ({ far }) => {
      if (!(far > 0)) return;
      const by = far / now;
      Object.assign(photo, { scale: photo.scale * by, x: x + (photo.x - x) * by, y: y + (photo.y - y) * by });
      const [u, v] = canvas.screen([x, y]);
      canvas.zoom(1 / by, [u, v]);
      this.#remember();
      studio.choose("draw");
      studio.say(`The photograph is to scale: ${this.#told(far)} between both points`);
    });
  }

  // locks and traces are kept with the window, the photograph in the browser's store: over a reload
  async #remember() {
    const { canvas, studio } = this;
    // a notebook has no window of its own to keep it for
    if (!studio.token) return;
    try { sessionStorage.setItem("compoundkin-studio-canvas", JSON.stringify({ token: studio.token, locks: canvas.locks, traced: [...canvas.toggled] })); } catch { /* full, or forbidden */ }
    try {
      const store = await this.#store("readwrite");
      if (canvas.photo) store.put(canvas.photo, studio.token);
      else store.delete(studio.token);
      await new Promise((resolve, reject) => Object.assign(store.transaction, { oncomplete: resolve, onerror: reject, onabort: reject }));
    } catch { if (canvas.photo) studio.say("The photograph cannot be kept over a reload in this browser"); }
  }

  #store(mode) {
    return new Promise((resolve, reject) => {
      const asked = indexedDB.open("compoundkin-studio", 1);
      asked.onupgradeneeded = () => asked.result.createObjectStore("kept");
      asked.onsuccess = () => resolve(asked.result.transaction("kept", mode).objectStore("kept"));
      asked.onerror = reject;
    });
  }

  async #recall() {
    const { canvas } = this;
    try {
      const { token, locks, traced } = JSON.parse(sessionStorage.getItem("compoundkin-studio-canvas")) ?? {};
      await Promise.resolve();
      if (token && token === this.studio.token) [canvas.locks, canvas.toggled] = [locks, new Set(traced)];
    } catch { /* nothing is kept */ }
    try {
      const asked = (await this.#store("readonly")).get(this.studio.token);
      asked.onsuccess = () => { if (asked.result && !canvas.photo) { canvas.photo = asked.result; canvas.draw(); } };
    } catch { /* no store */ }
  }
}
