// The view of a sketch: larger and back by buttons, keys, the wheel with Ctrl, two fingers; moved by its empty ground.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MOST = 16; // times as large, at most
  const STEP = 1.4; // of a button or key
  const WHEEL = 0.0022; // of the wheel: its logarithm for a pixel
  const PART = 0.15; // of the view that an arrow key moves it by
  const MOVED = 4; // pixels: less is a click

  class ViewBox {
    constructor(player) {
      Object.assign(this, { player, svg: player.svg, zoom: 1, middle: [0.5, 0.5], fingers: new Map() });
      this.buttons();
      this.keys();
      this.pointers();
      player.seeRoom = () => this.frame();
      player.viewBox = this;
      player.makeRoom();
    }

    // --- what is seen of the room that the picture takes ---------------------------------------------------------------
    get seen() {
      const { left, top, width, height } = this.player.room, wide = width / this.zoom, high = height / this.zoom;
      return { left: left + this.middle[0] * width - wide / 2, top: top + this.middle[1] * height - high / 2, wide, high };
    }
    frame() {
      const edge = 0.5 / this.zoom;
      this.middle = this.middle.map((at) => Math.min(Math.max(at, edge), 1 - edge));
      const { left, top, wide, high } = this.seen;
      this.svg.setAttribute("viewBox", `${left} ${top} ${wide} ${high}`);
      this.player.letters.isMeasured = false;
      this.svg.classList.toggle("zoomed", this.zoom > 1);
      if (this.controls) [this.in.disabled, this.out.disabled, this.whole.disabled] = [this.zoom >= MOST, this.zoom <= 1, this.zoom <= 1];
    }
    // `at` is a place on the screen that stays where it is
    by(factor, at = null) {
      const zoom = Math.min(Math.max(this.zoom * factor, 1), MOST);
      if (zoom === this.zoom) return;
      const before = at && this.place(at);
      this.zoom = zoom;
      this.frame();
      if (before) {
        const now = this.place(at), { width, height } = this.player.room;
        this.pan((before.x - now.x) / width, (before.y - now.y) / height);
      }
      this.player.fit();
      page.say && this.announce();
    }
    // by parts of the room
    pan(right, down) {
      this.middle = [this.middle[0] + right, this.middle[1] + down];
      this.frame();
    }
    fit() {
      this.zoom = 1;
      this.middle = [0.5, 0.5];
      this.frame();
      this.player.fit();
      this.announce();
    }
    announce() {
      if (document.getElementById("said")) page.say(this.zoom > 1 ? `${Math.round(this.zoom * 100)} percent` : "whole sketch");
    }
    // where a place of the screen is on the picture
    place([x, y]) {
      return new DOMPoint(x, y).matrixTransform(this.svg.getScreenCTM().inverse());
    }
    // pixels to parts of the room
    get pixel() {
      const scale = this.svg.getScreenCTM().a, { width, height } = this.player.room;
      return [1 / (scale * width), 1 / (scale * height)];
    }

    // --- by buttons and keys --------------------------------------------------------------------------------------------
    buttons() {
      const made = document.createElement("div");
      Object.assign(made, { className: "view" });
      made.setAttribute("role", "group");
      made.setAttribute("aria-label", "View of the sketch");
      const button = (text, label, act) => {
        const one = Object.assign(document.createElement("button"), { type: "button", textContent: text, title: label });
        one.setAttribute("aria-label", label);
        one.addEventListener("click", act);
        made.append(one);
        return one;
      };
      this.out = button("−", "Smaller", () => this.by(1 / STEP));
      this.in = button("+", "Larger", () => this.by(STEP));
      this.whole = button("Fit", "The whole sketch", () => this.fit());
      this.svg.after(made);
      this.controls = made;
      this.player.atEnd(() => made.remove());
    }
    keys() {
      this.svg.tabIndex = 0;
      this.svg.addEventListener("keydown", (event) => {
        if (event.target !== this.svg || event.ctrlKey || event.metaKey || event.altKey) return;
        const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
        if (way && this.zoom > 1) this.pan((way[0] * PART) / this.zoom, (way[1] * PART) / this.zoom);
        else if (["+", "="].includes(event.key)) this.by(STEP);
        else if (event.key === "-") this.by(1 / STEP);
        else if (event.key === "0") this.fit();
        else return;
        event.preventDefault();
      }, { signal: this.player.signal });
    }

    // --- by wheel, pointer and fingers ----------------------------------------------------------------------------------
    pointers() {
      const { svg, player: { signal } } = this;
      svg.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
        event.preventDefault();
        const pixels = event.deltaY * [1, 16, 100][event.deltaMode];
        this.by(Math.exp(-pixels * WHEEL * (Math.abs(pixels) < 40 ? 4 : 1)), [event.clientX, event.clientY]);
      }, { passive: false, signal });
      svg.addEventListener("pointerdown", (event) => {
        if (event.pointerType === "touch") this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
        const ground = !event.target.closest(".parts, [data-tool]");
        if (this.zoom > 1 && ground && event.button === 0 && this.fingers.size < 2) this.drag(event);
      }, { signal });
      addEventListener("pointermove", (event) => this.pinch(event), { signal });
      for (const kind of ["pointerup", "pointercancel"]) addEventListener(kind, (event) => this.fingers.delete(event.pointerId), { signal });
    }
    drag(event) {
      let last = [event.clientX, event.clientY], far = 0;
      const stop = new AbortController(), { signal } = stop;
      const on = (kind, act) => this.svg.addEventListener(kind, (told) => { if (told.pointerId === event.pointerId) act(told); }, { signal });
      this.svg.setPointerCapture(event.pointerId);
      this.svg.classList.add("panned");
      on("pointermove", (told) => {
        if (this.fingers.size > 1) return;
        const { pixel } = this, [dx, dy] = [told.clientX - last[0], told.clientY - last[1]];
        last = [told.clientX, told.clientY];
        far += Math.hypot(dx, dy);
        this.pan(-dx * pixel[0], -dy * pixel[1]);
      });
      const end = () => {
        stop.abort();
        this.svg.classList.remove("panned");
        // who moved the picture did not mean to press what is below the pointer
        if (far > MOVED) addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true, signal: AbortSignal.timeout(50) });
      };
      on("pointerup", end);
      on("pointercancel", end);
    }
    pinch(event) {
      const { fingers } = this;
      if (!fingers.has(event.pointerId)) return;
      const shape = () => {
        const [[ax, ay], [bx, by]] = [...fingers.values()];
        return { far: Math.hypot(ax - bx, ay - by), at: [(ax + bx) / 2, (ay + by) / 2] };
      };
      const before = fingers.size === 2 ? shape() : null;
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      if (!before) return;
      const now = shape(), { pixel } = this;
      this.pan((before.at[0] - now.at[0]) * pixel[0], (before.at[1] - now.at[1]) * pixel[1]);
      if (before.far > 0) this.by(now.far / before.far, now.at);
    }
  }

  page.ViewBox = ViewBox;
  page.attach((player) => new ViewBox(player));
})();
