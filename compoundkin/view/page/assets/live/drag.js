// Dragging: points of the sketch change the dimensions, drivers move the motion; by pointer, touch or keyboard.
// While a point is held, its links stay where they are at the pose shown: only the point moves on them.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MOVED = 3; // pixels: less is a click
  const TURN = 2 * Math.PI, DEGREE = 180 / Math.PI;
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  // beside the pointer four digits are enough
  const short = (value, unit) => page.withUnit(Number(value.toPrecision(4)), unit);
  const wrapped = (angle) => angle - TURN * Math.round(angle / TURN);

  class Drag {
    constructor(player) {
      this.player = player;
      this.design = player.design;
      this.held = null;
      this.handles = new page.Handles(player, this);
      this.numbers = new page.Readout(this.handles);
      this.free = new page.FreePose(player);
      document.addEventListener("keydown", (event) => { if (event.key === "Escape" && this.held) this.takeBack(); });
      player.svg.addEventListener("pointerdown", (event) => this.body(event));
    }

    // --- taken and let go ---------------------------------------------------------------------------------------------
    take(one, by) {
      if (this.held) this.drop();
      this.player.stop();
      this.held = { one, by, ...(one.kind === "point" ? this.holdPoint(one) : this.holdDriver(one)) };
      one.button.classList.add("held");
      if (by === "keys") one.button.setAttribute("aria-pressed", "true");
    }
    release() {
      const { one } = this.held;
      this.held = null;
      one.button.classList.remove("held");
      one.button.setAttribute("aria-pressed", "false");
      this.numbers.clear();
      this.handles.place();
    }
    drop() {
      const { one } = this.held;
      this.flush();
      if (one.kind === "point") this.design.commit(`${one.name} moved`);
      this.release();
    }
    takeBack() {
      const { one, pose, by } = this.held;
      this.held.waits = null;
      if (one.kind === "point") this.design.revert();
      else if (pose !== undefined) this.player.show(pose);
      this.release();
      if (by === "keys") this.numbers.say(`${one.label} is where it was.`);
    }

    // --- by pointer -----------------------------------------------------------------------------------------------------
    pointer(one, event, target = one.button) {
      const begun = [event.clientX, event.clientY], offset = [one.at[0], one.at[1]];
      const box = this.handles.layer.getBoundingClientRect();
      // from the pointer to the middle of the handle: it does not jump there
      const off = target === one.button ? [offset[0] - (begun[0] - box.left), offset[1] - (begun[1] - box.top)] : [0, 0];
      target.setPointerCapture(event.pointerId);
      const stop = new AbortController(), { signal } = stop;
      const on = (kind, act) => target.addEventListener(kind, (told) => { if (told.pointerId === event.pointerId) act(told); }, { signal });
      let moved = false;
      on("pointermove", (told) => {
        if (!moved && Math.hypot(told.clientX - begun[0], told.clientY - begun[1]) < MOVED) return;
        if (!moved) this.take(one, "pointer");
        moved = true;
        if (this.held && this.held.one === one) this.soon({ x: told.clientX + off[0], y: told.clientY + off[1], free: told.altKey || told.ctrlKey });
      });
      const end = (act) => () => {
        stop.abort();
        if (moved) addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true, signal: AbortSignal.timeout(50) });
        if (moved && this.held && this.held.one === one) act();
      };
      on("pointerup", end(() => this.drop()));
      on("pointercancel", end(() => this.takeBack()));
    }
    // a driven link itself is a handle too: whoever takes hold of a crank turns it
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
      const waits = this.held.waits;
      this.held.waits = told;
      if (!waits) requestAnimationFrame(() => this.flush());
    }
    flush() {
      const { held } = this, told = held && held.waits;
      if (!told) return;
      held.waits = null;
      const world = this.handles.toWorld(told.x, told.y);
      if (held.one.kind === "point") this.movePoint(world, told.free);
      else this.moveDriver(world);
    }

    // --- by keyboard ----------------------------------------------------------------------------------------------------
    toggle(one) {
      if (this.held) this.drop();
      else {
        this.take(one, "keys");
        this.numbers.say(`${one.label} taken. Arrows move it, Shift by ten times as much, Alt by a tenth; Enter leaves it there, Escape takes it back.`);
      }
    }
    left(one) {
      if (this.held && this.held.one === one && this.held.by === "keys") this.drop();
    }
    // tells whether the key was meant for what is held
    key(one, event) {
      const way = ARROWS[event.key];
      if (!way || !this.held || this.held.one !== one || this.held.by !== "keys") return false;
      event.preventDefault();
      const by = event.shiftKey ? 10 : event.altKey ? 0.1 : 1;
      if (one.kind === "driver") this.stepDriver((way[0] + way[1]) * by);
      else {
        const step = page.gridStep(this.handles.pixel) * by;
        const to = this.held.now.map((value, k) => (way[k] ? page.toStep(value + way[k] * step, step) : value));
        this.movePoint(to, true);
      }
      this.numbers.say(this.numbers.text);
      return true;
    }

    // --- points -------------------------------------------------------------------------------------------------------
    holdPoint({ name, data }) {
      const { player } = this, k = player.pose, start = player.place(name);
      const poses = data.links.map((link) => ({ link, ...this.pose(link, k) }));
      const rays = poses.filter(({ link }) => link).flatMap(({ link }) => page.pointsOf(player, link)
        .filter(({ letter }) => letter !== name).map((point) => player.at(link, point.x, point.y, k)))
        .map((from) => ({ from, along: [start[0] - from[0], start[1] - from[1]] }))
        .map(({ from, along }) => ({ from, size: Math.hypot(...along), along }))
        .filter(({ size }) => size > 0).map(({ from, along, size }) => ({ from, along: along.map((part) => part / size) }));
      const others = Object.keys(player.points).filter((letter) => letter !== name).map((letter) => player.place(letter, k))
        .filter(([x, y]) => Number.isFinite(x + y) && Math.hypot(x - start[0], y - start[1]) > 0);
      return { start, now: start, poses, rays, others, guide: data.on === undefined ? null : this.guide(data.on, name, k) };
    }
    pose(link, k) {
      const { x, y, angle } = this.player.links[link];
      return { x: x[k], y: y[k], c: Math.cos(angle[k]), s: Math.sin(angle[k]) };
    }
    // the direction in which a point runs along its guide: from where it is to where it is farthest on the link of the guide
    guide(on, letter, k) {
      const { player } = this, here = this.pose(on, k);
      const own = (at) => {
        const { x, y, c, s } = this.pose(on, at), [px, py] = player.place(letter, at);
        return [c * (px - x) + s * (py - y), c * (py - y) - s * (px - x)];
      };
      const from = own(k);
      let best = [0, 0], far = 0;
      for (let at = 0; at < player.poses; at++) {
        const to = own(at), away = Math.hypot(to[0] - from[0], to[1] - from[1]);
        if (away > far) [far, best] = [away, [to[0] - from[0], to[1] - from[1]]];
      }
      return far > 0 ? [(here.c * best[0] - here.s * best[1]) / far, (here.s * best[0] + here.c * best[1]) / far] : null;
    }
    movePoint(world, free) {
      const { held, design, player } = this, step = page.gridStep(this.handles.pixel);
      const found = held.guide ? this.onGuide(world, free ? 0 : step) : free ? { at: world, lines: [] }
        : page.snapped(world, { step, pixel: this.handles.pixel, others: held.others, rays: held.rays });
      const { width, height, scale } = player.data.window, fine = page.finest(Math.max(width, height) / scale);
      held.now = found.at;
      const values = {};
      for (const { link, x, y, c, s } of held.poses) {
        const dx = found.at[0] - x, dy = found.at[1] - y, base = `${player.data.links[link].name}.${held.one.name}`;
        values[`${base}.x`] = page.toStep(c * dx + s * dy, fine);
        values[`${base}.y`] = page.toStep(c * dy - s * dx, fine);
      }
      design.change(values);
      this.numbers.show(held.one, found, this.lengths(held.one));
    }
    onGuide([x, y], step) {
      const { start, guide } = this.held, main = Math.abs(guide[0]) >= Math.abs(guide[1]) ? 0 : 1;
      let along = guide[0] * (x - start[0]) + guide[1] * (y - start[1]);
      if (step) along = (page.toStep(start[main] + along * guide[main], step) - start[main]) / guide[main];
      return { at: [start[0] + along * guide[0], start[1] + along * guide[1]], lines: [] };
    }
    // of each link on which it moves: how far it is from the other points, and in which direction on the link
    lengths({ name, data }) {
      const { player } = this, { unit } = player.data;
      return data.links.filter((link) => link || data.links.length === 1).flatMap((link) => {
        const points = page.pointsOf(player, link), own = points.find(({ letter }) => letter === name);
        return points.filter(({ letter }) => letter !== name).map(({ letter, x, y }) => {
          const angle = Math.atan2(own.y - y, own.x - x) * DEGREE;
          return `${player.data.links[link].name} ${letter}${name} ${short(Math.hypot(own.x - x, own.y - y), unit)}, ${short(angle, "deg")}`;
        });
      });
    }

    // --- drivers ------------------------------------------------------------------------------------------------------
    holdDriver({ data }) {
      return { pose: this.player.pose, start: null, index: this.player.data.live.drives.findIndex(({ name }) => name === data.name) };
    }
    // how much the driver's own value changes when its link follows the pointer
    wanted(world) {
      const { held, player } = this, { link, at, turns } = held.one.data, k = player.pose, pivot = player.place(at);
      if (turns) {
        const pointed = Math.atan2(world[1] - pivot[1], world[0] - pivot[0]) - player.links[link].angle[k];
        held.start ??= pointed;
        return wrapped(pointed - held.start);
      }
      held.way ??= this.guide(0, at, k) || [1, 0];
      const along = held.way[0] * (world[0] - pivot[0]) + held.way[1] * (world[1] - pivot[1]);
      held.start ??= along;
      return along - held.start;
    }
    moveDriver(world) {
      this.byDriver(this.wanted(world));
    }
    stepDriver(by) {
      const { held, player } = this;
      if (player.drivers.length === 1) player.show(((player.pose + Math.round(by) + Math.sign(by) * (Math.abs(by) < 1)) % player.poses + player.poses) % player.poses);
      else this.byDriver(held.one.data.turns ? by / DEGREE : by * page.gridStep(this.handles.pixel));
      this.tellDriver();
    }
    // the pose of the motion that is nearest; of several drivers, this one's own value
    byDriver(change) {
      const { held, player, design } = this;
      if (player.drivers.length === 1) {
        const values = design.path.drives[held.index][0], target = values[player.pose] + change;
        const round = held.one.data.turns && player.data.closes ? wrapped : (away) => away;
        let best = player.pose, least = Infinity;
        for (let k = 0; k < values.length; k++) {
          const away = Math.abs(round(values[k] - target)) + 1e-9 * Math.abs(k - player.pose);
          if (away < least) [least, best] = [away, k];
        }
        player.show(best);
      } else this.free.move(held.index, change);
      this.tellDriver();
    }
    tellDriver() {
      const { one } = this.held, told = this.player.drivers.find(({ name }) => name === one.name);
      this.numbers.show(one, { at: null, lines: [] }, [page.withUnit(told.parts[""][this.player.pose], told.unit)]);
    }
  }

  page.Drag = Drag;
  for (const player of page.players) if (player.design && player.data.live.handles) player.drag = new Drag(player);
})();
