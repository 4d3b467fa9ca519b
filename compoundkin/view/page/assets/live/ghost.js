// The ghost: the mechanism as it was, pale behind one that is changed, at the same pose.
(() => {
  "use strict";
  const page = window.compoundkin;

  class Ghost {
    constructor(player) {
      this.player = player;
      // copied before anything is changed; names would stand in the way
      const kept = player.parts.map((part, index) => ({ part, place: [...player.data.parts[index]] })).filter(({ part }) => !part.classList.contains("name"));
      this.layer = page.drawn("g", { class: "former ck-ghost", "aria-hidden": "true", "data-tool": "" });
      this.parts = kept.map(({ part, place }) => {
        const own = part.cloneNode(true);
        for (const key of ["data-links", "data-letter"]) own.removeAttribute(key);
        this.layer.append(own);
        return { own, place, drawn: "" };
      });
      this.isShown = false;
      player.listeners.push(() => this.move());
    }
    follow() {
      const { isChanged } = this.player.design;
      if (isChanged === this.isShown) return;
      this.isShown = isChanged;
      if (isChanged) this.player.svg.querySelector(".parts").before(this.layer);
      else this.layer.remove();
      this.at = -1;
      this.move();
    }
    // the pose changes, the original's numbers do not
    move() {
      const { player } = this, k = player.pose, { assembled, links } = player.given || {};
      if (!this.isShown || k === this.at || assembled[k] !== 1) return;
      this.at = k;
      for (const one of this.parts) {
        const drawn = player.placement(links, one.place, k);
        if (drawn !== one.drawn) one.own.setAttribute("transform", drawn);
        one.drawn = drawn;
      }
    }
  }

  page.Ghost = Ghost;
})();
