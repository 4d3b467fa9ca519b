// Handles: what can be taken hold of in the sketch, as buttons above it. One stop of the keyboard; arrows go from one to the next.
(() => {
  "use strict";
  const page = window.compoundkin;
  const REACH = 20, OF_FINGERS = 30; // pixels around a handle within which it is meant
  const OUT = 34; // pixels from a driven link's farthest point, or from a driven slide, to the driver's handle

  class Handles {
    constructor(player, hold) {
      this.player = player;
      this.hold = hold; // what happens to a handle that is taken: drag.js
      const figure = player.svg.closest("figure");
      figure.classList.add("live");
      this.layer = page.made("div", { class: "handles", role: "toolbar", "aria-label": "Points and drivers to drag" }, figure);
      const { points, drivers } = player.data.live.handles;
      this.all = [
        ...points.filter((point) => this.isFree(point)).map((point) => this.handle("point", point, `Point ${point.name}`)),
        ...drivers.map((driver) => this.handle("driver", driver, `Driver ${driver.name}`)),
      ];
      this.stop = this.all[0];
      if (this.stop) this.stop.button.tabIndex = 0;
      this.listen();
      player.listeners.push(() => this.place());
      player.watch(new ResizeObserver(() => this.measure()), player.svg, figure);
      const framed = new MutationObserver(() => this.measure());
      framed.observe(player.svg, { attributeFilter: ["viewBox", "preserveAspectRatio"] });
      player.atEnd(() => { framed.disconnect(); this.layer.remove(); });
      this.measure();
    }
    // a point all of whose coordinates on its links are dimensions
    isFree({ name, links }) {
      const { design, data } = this.player;
      return links.length > 0 && links.every((link) => ["x", "y"].every((part) => design.index.has(`${data.links[link].name}.${name}.${part}`)));
    }
    handle(kind, data, label) {
      const button = page.made("button", { type: "button", class: `handle ${kind}`, tabindex: -1, "aria-label": label, "aria-pressed": "false" }, this.layer);
      button.title = kind === "driver" ? `Drag to drive ${data.name}` : `Drag ${data.name}`;
      if (kind === "driver") page.made("span", { class: "called", "aria-hidden": "true" }, button).textContent = data.name;
      return { kind, data, label, button, name: data.name, at: null, drawn: "" };
    }
    of(button) {
      return this.all.find((one) => one.button === button);
    }

    // --- where they are, in pixels from the figure's corner; measured when the picture's frame changes -----------------
    measure() {
      const map = this.player.svg.getScreenCTM(), box = this.layer.getBoundingClientRect(), seen = this.player.svg.getBoundingClientRect();
      if (!map || !box.width) return;
      this.width = box.width;
      this.map = { scale: map.a, x: map.e - box.left, y: map.f - box.top };
      this.seen = { left: seen.left - box.left - 1, top: seen.top - box.top - 1, right: seen.right - box.left + 1, bottom: seen.bottom - box.top + 1 };
      this.place();
    }
    toScreen(world) {
      const [x, y] = this.player.paper(world);
      return [this.map.x + x * this.map.scale, this.map.y + y * this.map.scale];
    }
    toWorld(clientX, clientY) {
      const box = this.layer.getBoundingClientRect(), { window } = this.player.data;
      const x = (clientX - box.left - this.map.x) / this.map.scale, y = (clientY - box.top - this.map.y) / this.map.scale;
      return [x / window.scale + window.x, window.y - y / window.scale];
    }
    // so long is a pixel in the user's unit
    get pixel() {
      return 1 / (this.map.scale * this.player.data.window.scale);
    }
    place() {
      if (!this.map) return;
      for (const one of this.all) {
        one.at = one.kind === "point" ? this.toScreen(this.player.place(one.name)) : this.besideDriver(one);
        const [x, y] = one.at;
        const drawn = this.isSeen(x, y) || (this.isHeld(one) && Number.isFinite(x + y)) ? `translate(${x.toFixed(1)}px,${y.toFixed(1)}px)` : "";
        if (drawn === one.drawn) continue;
        one.button.style.transform = drawn;
        if (!drawn !== !one.drawn || one.button.hidden) one.button.hidden = !drawn;
        one.drawn = drawn;
      }
      if (this.stop && this.stop.button.hidden) this.settle(this.all.find((one) => !one.button.hidden) || this.stop);
    }
    isSeen(x, y) {
      const { left, top, right, bottom } = this.seen;
      return x >= left && x <= right && y >= top && y <= bottom;
    }
    // beyond the farthest point of a link that is turned, beside a slide; on the other side where that is out of the picture
    besideDriver(one) {
      const { player } = this, { link, at, turns } = one.data, pivot = this.toScreen(player.place(at));
      let [dx, dy] = turns ? this.onScreen(player.links[link].angle[player.pose]) : this.across(one), far = 0;
      for (const point of turns ? page.pointsOf(player, link) : []) {
        const [x, y] = this.toScreen(player.at(link, point.x, point.y, player.pose)), away = Math.hypot(x - pivot[0], y - pivot[1]);
        if (away > far + 1) [far, dx, dy] = [away, (x - pivot[0]) / away, (y - pivot[1]) / away];
      }
      const place = (by) => [pivot[0] + dx * by, pivot[1] + dy * by], out = place(far + OUT);
      // under a pointer it does not jump
      return this.isSeen(...out) || this.isHeld(one) ? out : place(-OUT);
    }
    onScreen(angle) {
      return [Math.cos(angle), -Math.sin(angle)];
    }
    // at right angles to the guide of a driven slide, which keeps its direction on the link that carries it
    across(one) {
      const { player } = this, { link, on, at } = one.data, k = player.pose, carrier = player.links[on].angle;
      if (!Number.isFinite(one.along)) {
        const found = page.guideOf(player, on, at, k), along = found ? Math.atan2(found.along[1], found.along[0]) : player.links[link].angle[k];
        one.along = along - carrier[k];
      }
      return this.onScreen(one.along + carrier[k] + Math.PI / 2);
    }
    isHeld(one) {
      return Boolean(this.hold.held) && this.hold.held.one === one;
    }
    nearest(clientX, clientY, kind) {
      const box = this.layer.getBoundingClientRect(), x = clientX - box.left, y = clientY - box.top;
      let best = null, away = kind === "touch" ? OF_FINGERS : REACH;
      for (const one of this.all) {
        const own = one.button.hidden ? Infinity : Math.hypot(one.at[0] - x, one.at[1] - y);
        if (own < away) [best, away] = [one, own];
      }
      return best;
    }

    // --- pointer and keyboard -----------------------------------------------------------------------------------------
    listen() {
      this.layer.addEventListener("pointerdown", (event) => {
        const one = event.button === 0 && event.isPrimary && this.nearest(event.clientX, event.clientY, event.pointerType);
        if (!one) return;
        event.preventDefault();
        this.settle(one);
        one.button.focus({ preventScroll: true, focusVisible: false });
        this.hold.pointer(one, event);
      });
      this.layer.addEventListener("keydown", (event) => {
        const one = this.of(event.target);
        if (one && !this.hold.key(one, event)) this.walk(one, event);
      });
      // Enter, Space, and what presses buttons for those who see no picture
      this.layer.addEventListener("click", (event) => {
        const one = this.of(event.target.closest("button"));
        if (one && event.detail === 0) this.hold.toggle(one);
      });
      this.layer.addEventListener("focusout", (event) => {
        const one = this.of(event.target);
        if (one) this.hold.left(one);
      });
    }
    walk(one, event) {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const seen = this.all.filter((other) => !other.button.hidden), k = seen.indexOf(one), last = seen.length - 1;
      const to = { ArrowRight: k + 1, ArrowDown: k + 1, ArrowLeft: k - 1, ArrowUp: k - 1, Home: 0, End: last }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      this.settle(seen[to < 0 ? last : to > last ? 0 : to]);
      this.stop.button.focus({ preventScroll: true });
    }
    settle(one) {
      this.stop.button.tabIndex = -1;
      this.stop = one;
      one.button.tabIndex = 0;
    }
  }

  // the points of a link, in its own frame as the dimensions have them
  page.pointsOf = (player, link) => {
    const { name } = player.data.links[link];
    const found = [];
    for (const [letter, carried] of player.design.carried) {
      const own = carried.find((one) => one.link === name);
      if (own) found.push({ letter, x: player.design.numbers[own.x], y: player.design.numbers[own.y] });
    }
    return found;
  };
  page.Handles = Handles;
})();
