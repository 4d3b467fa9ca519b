// Dragging: points of the sketch change the dimensions, drivers move the motion; by pointer, touch or keyboard.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MOVED = 3; // pixels: less is a click
  const AFTER = 50; // milliseconds within which a click belongs to what was dragged
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const KEYS = "Arrows move it, Shift by ten times as much, Alt by a tenth; Enter leaves it there, Escape takes it back.";

  class Drag {
    constructor(player) {
      this.player = player;
      this.held = null;
      this.handles = new page.Handles(player, this);
      this.numbers = new page.Readout(this.handles);
      this.free = new page.FreePose(player);
      const { signal } = player;
      document.addEventListener("keydown", (event) => { if (event.key === "Escape" && this.held) this.takeBack(); }, { signal });
      player.svg.addEventListener("pointerdown", (event) => this.body(event), { signal });
      player.atEnd(() => { cancelAnimationFrame(this.frame); this.listening?.abort(); });
    }

    // --- taken and let go ---------------------------------------------------------------------------------------------
    take(one, by) {
      if (this.held) this.drop();
      this.player.transport.stop();
      this.held = one.kind === "point" ? new page.PointHold(this, one) : new page.DriverHold(this, one);
      this.by = by;
      this.waits = null;
      one.button.classList.add("held");
      this.player.svg.classList.add("dragging"); // the picture's frame stays as it is
      if (by === "keys") one.button.setAttribute("aria-pressed", "true");
    }
    drop() {
      const { held } = this;
      this.flush();
      this.release();
      held.drop();
    }
    takeBack() {
      const { held } = this, { one } = held;
      this.waits = null;
      this.release();
      held.takeBack();
      if (this.by === "keys") this.numbers.say(`${one.label} is where it was.`);
    }
    release() {
      const { button } = this.held.one;
      this.held = null;
      button.classList.remove("held");
      this.player.svg.classList.remove("dragging");
      button.setAttribute("aria-pressed", "false");
      this.numbers.clear();
      this.handles.place();
    }

    // --- by pointer -----------------------------------------------------------------------------------------------------
    pointer(one, event, target = one.button) {
      const begun = [event.clientX, event.clientY], { left, top } = this.handles.layer.getBoundingClientRect();
      // from the pointer to the middle of the handle: it does not jump there
      const off = target === one.button ? [one.at[0] - (begun[0] - left), one.at[1] - (begun[1] - top)] : [0, 0];
      const listening = (this.listening = new AbortController()), { signal } = listening;
      const on = (kind, act) => target.addEventListener(kind, (told) => { if (told.pointerId === event.pointerId) act(told); }, { signal });
      const isMine = () => this.held && this.held.one === one;
      let moved = false;
      // of a link not before it moves: a click shall be one on the link that is pressed
      const capture = () => target.setPointerCapture(event.pointerId);
      if (target === one.button) capture();
      on("pointermove", (told) => {
        if (!moved && Math.hypot(told.clientX - begun[0], told.clientY - begun[1]) < MOVED) return;
        if (!moved) {
          capture();
          this.take(one, "pointer");
        }
        moved = true;
        if (isMine()) this.soon({ x: told.clientX + off[0], y: told.clientY + off[1], free: told.altKey || told.ctrlKey, only: told.shiftKey });
      });
      const end = (act) => () => {
        listening.abort();
        // what was dragged is not clicked too
        if (moved) addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true, signal: AbortSignal.timeout(AFTER) });
        if (moved && isMine()) act();
      };
      on("pointerup", end(() => this.drop()));
      on("pointercancel", end(() => this.takeBack()));
    }
    // a driven link itself is a handle too: whoever takes hold of a crank turns it; fingers scroll there
    body(event) {
      const part = event.target.closest && event.target.closest(".parts > g");
      if (!part || event.button !== 0 || !event.isPrimary || event.pointerType === "touch") return;
      const one = this.handles.all.find(({ kind, data }) => kind === "driver" && this.player.data.links[data.link].name === part.dataset.links);
      if (!one) return;
      event.stopPropagation();
      this.pointer(one, event, this.player.svg);
    }
    // once for each picture that the screen shows, however often the pointer tells
    soon(told) {
      const { waits } = this;
      this.waits = told;
      if (!waits) this.frame = requestAnimationFrame(() => this.flush());
    }
    flush() {
      const told = this.waits;
      this.waits = null;
      if (told && this.held) this.held.move(this.handles.toWorld(told.x, told.y), told.free, told.only);
    }

    // --- by keyboard ----------------------------------------------------------------------------------------------------
    toggle(one) {
      if (this.held) this.drop();
      else {
        this.take(one, "keys");
        this.numbers.say(`${one.label} taken. ${KEYS}`);
      }
    }
    left(one) {
      if (this.isByKeys(one)) this.drop();
    }
    // tells whether the key was meant for what is held
    key(one, event) {
      const way = ARROWS[event.key];
      if (!way || !this.isByKeys(one)) return false;
      event.preventDefault();
      this.held.step(way, event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
      this.numbers.say(this.numbers.text);
      return true;
    }
    isByKeys(one) {
      return this.held && this.held.one === one && this.by === "keys";
    }
  }

  page.Drag = Drag;
  page.attach((player) => { if (player.design && player.data.live.handles) player.drag = new Drag(player); });
})();
