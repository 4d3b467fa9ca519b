// Scales of velocities and accelerations: another one where those of a changed mechanism would be far too long or too short.
// They change with a step, not while something is dragged: so arrows can be compared.
(() => {
  "use strict";
  const page = window.compoundkin;
  const ORDERS = { velocity: 1, acceleration: 2 };
  const LONGEST = 0.2; // of the picture's diagonal: so long is the longest vector of the page as it came
  const SHORT = 0.4, LONG = 1.6; // parts of that within which the scale stays

  const roundBelow = (value) => {
    const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
    return Number((Math.max(...[1, 2, 5].filter((step) => step * power <= value * (1 + 1e-9))) * power).toPrecision(1));
  };

  class VectorScales {
    constructor(player) {
      this.player = player;
      this.own = { ...player.data.vectors };
      const { width, height } = player.data.window;
      this.reach = LONGEST * Math.hypot(width, height);
      player.design.on("commit", () => this.follow());
    }
    longest(kind) {
      const { player } = this;
      let most = 0;
      for (const letter in player.points) {
        for (let k = 0; k < player.poses; k++) {
          const size = Math.hypot(...player.rate(letter, ORDERS[kind], k));
          if (size > most) most = size;
        }
      }
      return most;
    }
    follow() {
      const { player, own } = this;
      for (const kind in own) {
        const longest = this.longest(kind), part = (longest * own[kind].scale) / this.reach;
        const fits = !(longest > 0) || (part > SHORT && part < LONG);
        player.data.vectors[kind] = fits ? own[kind] : this.scaled(kind, this.reach / longest, roundBelow(longest));
      }
      player.makeRoom();
      player.overlays.draw();
    }
    scaled(kind, scale, amount) {
      const { text } = this.own[kind];
      return { ...this.own[kind], scale, length: amount * scale, text: `${page.written(amount)}${text.slice(text.indexOf(" "))}` };
    }
  }

  page.attach((player) => { if (player.design) player.vectorScales = new VectorScales(player); });
})();
