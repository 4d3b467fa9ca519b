// The transport of a player: its slider, a pose back and forth, and playing at a speed.
(() => {
  "use strict";
  const page = window.compoundkin;
  const LONGEST = 100; // milliseconds between two pictures: a page that was out of sight goes on from where it was

  class Transport {
    constructor(player) {
      this.player = player;
      this.playing = false;
      const one = (selector) => player.root.querySelector(selector);
      Object.assign(this, { slider: one(".slider"), play: one(".play"), where: one(".where"), choice: one(".speed") });
      const { signal } = player;
      this.slider.addEventListener("input", () => this.to(this.asked), { signal });
      one(".back").addEventListener("click", () => this.step(-1), { signal });
      one(".forth").addEventListener("click", () => this.step(1), { signal });
      this.play.addEventListener("click", () => (this.playing ? this.stop() : this.start()), { signal });
      if (player.poses < 2) for (const control of player.root.querySelectorAll(".transport :is(button, input, select)")) control.disabled = true;
    }
    // the pose that the slider is at
    get asked() {
      return Number(this.slider.value);
    }
    to(pose) {
      this.stop();
      this.player.show(pose);
    }
    step(by) {
      const { player } = this, count = player.poses;
      this.to((player.pose + by + count) % count);
    }
    // says where a pose is
    tell(pose, where, isAssembled) {
      this.slider.value = pose;
      this.where.textContent = where;
      this.slider.setAttribute("aria-valuetext", isAssembled ? where : `${where}, cannot be assembled`);
    }

    start() {
      this.playing = true;
      this.pressed();
      const { player } = this, last = player.poses - 1, period = player.data.seconds * 1000;
      // how far the motion is, in poses; one that does not close goes there and back
      let at = player.pose, way = 1, before = null;
      const tick = (now) => {
        if (!this.playing) return;
        if (before !== null) at += (way * Math.min(now - before, LONGEST) * Number(this.choice.value) * last) / period;
        before = now;
        if (player.data.closes) at = ((at % last) + last) % last;
        else if (at > last || at < 0) { way = -way; at = Math.min(Math.max(at, 0), last); }
        player.show(Math.round(at));
        this.frame = requestAnimationFrame(tick);
      };
      this.frame = requestAnimationFrame(tick);
    }
    stop() {
      if (!this.playing) return;
      this.playing = false;
      cancelAnimationFrame(this.frame);
      this.pressed();
    }
    pressed() {
      this.play.setAttribute("aria-pressed", String(this.playing));
      this.play.firstElementChild.textContent = this.playing ? "Pause" : "Play";
    }
  }

  page.Transport = Transport;
})();
