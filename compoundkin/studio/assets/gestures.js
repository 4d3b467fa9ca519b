// One state machine for mouse, finger, pen and keyboard: what is pressed, what it would do, the edit that comes of it.
const FAR = 5, FINGER = 1.7, NEW_BAR = 90;

export class Gestures {
  constructor(canvas, studio) {
    Object.assign(this, { canvas, studio, tool: "draw", held: null });
    const { svg } = canvas;
    svg.addEventListener("pointerdown", (event) => this.press(event));
    svg.addEventListener("pointermove", (event) => this.move(event));
    svg.addEventListener("pointerup", (event) => this.release(event));
    svg.addEventListener("pointercancel", () => this.stop());
    svg.addEventListener("pointerleave", () => { if (!this.held) this.#look(null); });
    svg.addEventListener("contextmenu", (event) => event.preventDefault());
    svg.addEventListener("wheel", (event) => {
      event.preventDefault();
      canvas.zoom(Math.exp(-event.deltaY / 400), this.#at(event));
    }, { passive: false });
  }

  choose(tool) {
    this.tool = tool;
    this.#hint();
  }

  #at(event) {
    const box = this.canvas.svg.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  press(event) {
    if (this.held) { this.stop(); return; }
    const at = this.#at(event), reach = event.pointerType === "mouse" ? 1 : FINGER;
    const under = this.canvas.under(at, reach);
    this.canvas.svg.focus({ preventScroll: true });
    try { this.canvas.svg.setPointerCapture(event.pointerId); } catch { /* a pointer that is no more */ }
    const isMoving = (this.tool === "move") !== event.shiftKey;
    const handle = this.canvas.handle;
    let does = under?.point ? (isMoving ? "move" : "bar") : isMoving ? (under ? "choose" : "pan") : "bar";
    if (event.button === 1 || event.button === 2 || event.ctrlKey) does = "pan";
    else if (under?.point && under.point === handle && isMoving && !event.altKey) does = "drive";
    this.studio.halt();
    this.held = { does, under, reach, start: at, last: at, isDragged: false, isTorn: event.altKey };
  }

  move(event) {
    const at = this.#at(event), held = this.held;
    this.pointer = at;
    if (!held) { this.#look(this.canvas.under(at)); return; }
    if (!held.isDragged && Math.hypot(at[0] - held.start[0], at[1] - held.start[1]) < FAR) return;
    held.isDragged = true;
    if (held.does === "pan") this.canvas.pan([at[0] - held.last[0], at[1] - held.last[1]]);
    else if (held.does === "drive") this.studio.drive(held.under.point, this.canvas.plane(at));
    else if (held.does === "move") this.#drag(at);
    else if (held.does === "bar") this.#stretch(at);
    held.last = at;
  }

  #drag(at) {
    const { held, canvas } = this, letter = held.under.point;
    held.over = canvas.under(at, held.reach, [letter]);
    if (!held.over?.point) held.over = null;
    if (!held.isTorn) canvas.moved = { [letter]: canvas.plane(at) };
    canvas.draw();
    canvas.sketch(held.isTorn ? canvas.at(letter) : null, at, held.over && canvas.at(held.over.point));
    this.studio.say(held.isTorn ? `Let go: takes a bar off ${letter}` : held.over ? `Let go: joins ${letter} to ${held.over.point}` : `Moves ${letter}`);
  }

  #stretch(at) {
    const { held, canvas } = this, from = held.under?.point ? canvas.at(held.under.point) : held.start;
    held.over = canvas.under(at, held.reach, held.under?.point ? [held.under.point] : []);
    if (held.over?.link && held.over.link === held.under?.link) held.over = null;
    const to = held.over?.point ? canvas.at(held.over.point) : at;
    canvas.sketch(from, to, held.over ? to : null);
    const [x, y] = canvas.plane(from), [u, v] = canvas.plane(to);
    const long = Number(Math.hypot(u - x, v - y).toPrecision(4));
    const where = held.over?.point ? `to ${held.over.point}` : held.over?.link ? `onto ${held.over.link}` : "";
    this.studio.say(`A bar of ${long} ${this.studio.unit} ${where}`);
  }

  release(event) {
    const held = this.held, at = this.#at(event), { canvas, studio } = this;
    this.stop();
    this.#hint();
    if (!held) return;
    if (!held.isDragged) {
      canvas.chosen = held.does === "pan" ? null : held.under;
      canvas.draw();
      this.#hint();
      return;
    }
    const place = canvas.rounded(canvas.plane(at));
    if (held.does === "move") {
      const letter = held.under.point;
      if (held.isTorn) {
        const moving = studio.linksAt(letter).filter((one) => one !== "frame");
        if (moving.length) studio.edit({ do: "tear", point: letter, link: moving.at(-1), to: place });
      } else if (held.over) studio.edit({ do: "join", point: letter, with: held.over.point });
      else studio.edit({ do: "move", point: letter, to: place });
    } else if (held.does === "bar") {
      const end = (what, where) => (what?.point ? { point: what.point } : what?.link ? { link: what.link, at: where } : { at: where });
      const from = end(held.under, canvas.rounded(canvas.plane(held.start)));
      studio.edit({ do: "bar", from, to: end(held.over, place) });
    }
  }

  stop() {
    this.held = null;
    this.canvas.moved = {};
    this.canvas.sketch();
    this.canvas.draw();
  }

  #look(over) {
    const { canvas } = this;
    if (over?.point === canvas.over?.point && over?.link === canvas.over?.link) return;
    canvas.over = over;
    canvas.draw();
    this.#hint();
  }

  #hint() {
    const { over, chosen } = this.canvas, it = over ?? chosen, draws = this.tool === "draw";
    const what = it?.point
      ? `${it.point}: ${draws ? "drag for a bar" : "drag to move it, onto a point to join, with Alt to take a bar off"}; G ground, D driver, S slide, Delete`
      : it?.link ? `${it.link}: ${draws ? "drag from it for a bar; a bar dropped on it gets a pin there" : "click to choose it"}; chosen, P gives it a point where the pointer is; Delete`
        : draws ? "Drag: a bar. Onto a point or a bar: joined there. With Shift: move points" : "Drag a point. Drag the ground: the view. Wheel: nearer";
    this.studio.say(what);
  }

  // the point or link that keys and buttons mean: what is under the pointer, else what is chosen
  get meant() { return this.canvas.over ?? this.canvas.chosen ?? null; }

  act(what) {
    const { studio, canvas } = this, it = what === "delete" ? canvas.chosen ?? canvas.over : this.meant;
    if (!it) { studio.say("Choose a point or a bar first: click it"); return; }
    if (what === "point") {
      if (canvas.chosen?.link && this.pointer) studio.edit({ do: "point", link: canvas.chosen.link, at: canvas.rounded(canvas.plane(this.pointer)) });
      else studio.say("Choose a bar first: click it");
    } else if (what === "delete") {
      canvas.chosen = canvas.over = null;
      studio.edit(it.point ? { do: "delete", point: it.point } : { do: "delete", link: it.link });
    } else if (what === "slide" && it.link && canvas.chosen?.point) {
      studio.edit({ do: "slide", point: canvas.chosen.point, on: it.link });
    } else if (!it.point) {
      studio.say(`Choose a point of ${it.link}: click it`);
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

  // the chosen point by the keyboard: moved by arrows, a bar from it
  nudge(by) {
    const { canvas, studio } = this, letter = canvas.chosen?.point;
    if (!letter) return;
    const [x, y] = canvas.at(letter);
    studio.edit({ do: "move", point: letter, to: canvas.rounded(canvas.plane([x + by[0], y + by[1]])) });
  }

  bar() {
    const { canvas, studio } = this, letter = canvas.chosen?.point;
    const [x, y] = letter ? canvas.at(letter) : canvas.size.map((one) => one / 2);
    const from = letter ? { point: letter } : { at: canvas.rounded(canvas.plane([x, y])) };
    studio.edit({ do: "bar", from, to: { at: canvas.rounded(canvas.plane([x + NEW_BAR, y - NEW_BAR / 2])) } });
  }
}
