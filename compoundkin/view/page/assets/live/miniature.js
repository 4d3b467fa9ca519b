// Where the sketch is far above the field that changes it a small one stands at the edge: above on a phone, in a corner else.
(() => {
  "use strict";
  const page = window.compoundkin;
  const NARROW = matchMedia("(max-width: 67.99rem)"); // where it stands above, over the whole width

  class Miniature {
    // shows the sketch of a player again while a field in `place` is focused and the sketch itself is out of sight
    constructor(player, place) {
      Object.assign(this, { player, waits: 0 });
      this.root = document.createElement("div");
      this.root.className = "miniature";
      this.root.ariaHidden = "true";
      this.root.hidden = true;
      document.body.append(this.root);
      const { signal } = player;
      place.addEventListener("focusin", (event) => this.show(event.target), { signal });
      place.addEventListener("focusout", () => this.hide(), { signal });
      player.atEnd(() => { cancelAnimationFrame(this.waits); this.root.remove(); });
      player.listeners.push(() => this.soon());
      player.design.on("change", () => this.soon());
      document.addEventListener("compoundkin:light", () => this.soon(), { signal });
    }
    show(field) {
      if (!field.matches("input") || this.player.svg.getBoundingClientRect().bottom > innerHeight / 4) return;
      this.root.hidden = false;
      this.draw();
      // what is typed stays in sight below it
      if (!NARROW.matches) return;
      const covered = this.root.getBoundingClientRect().bottom + 8 - field.getBoundingClientRect().top;
      if (covered > 0) scrollBy(0, -covered);
    }
    hide() {
      this.root.hidden = true;
      this.root.replaceChildren();
    }
    soon() {
      if (!this.root.hidden && !this.waits) this.waits = requestAnimationFrame(() => this.draw());
    }
    // a copy, since what is only referred to does not get the colours of dark pages
    draw() {
      this.waits = 0;
      if (this.root.hidden) return;
      const copy = this.player.svg.cloneNode(true);
      for (const one of [copy, ...copy.querySelectorAll("[tabindex]")]) one.removeAttribute("tabindex");
      this.root.replaceChildren(copy);
    }
  }

  const place = document.querySelector("#dimensions .dimensions"), [player] = page.players;
  if (place && player?.design) player.miniature = new Miniature(player, place);
})();
