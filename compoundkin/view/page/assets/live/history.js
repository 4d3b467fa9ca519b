// The way back: undo, redo, the original dimensions; by button and key; the original mechanism pale behind a changed one.
(() => {
  "use strict";
  const page = window.compoundkin;
  const TYPED = "input:not([type=range], [type=checkbox], [type=radio], [type=button]), textarea, select, [contenteditable]";
  const HINT = "Drag a point to change the mechanism, a driver to move it (by keyboard: Tab, Enter, arrows). With Shift only one length changes.";
  const FORCES = "Forces are of the original dimensions; they are not shown while these are changed.";

  const MOST_GAPS = 4; // told in words

  class History {
    constructor(player) {
      this.player = player;
      this.design = player.design;
      const row = document.createElement("div");
      row.className = "changes";
      row.setAttribute("role", "group");
      row.setAttribute("aria-label", "Changes of dimensions");
      player.root.querySelector(".transport").after(row);
      this.undo = this.button("Undo", row, () => this.design.undo());
      this.redo = this.button("Redo", row, () => this.design.redo());
      this.reset = this.button("Original", row, () => this.design.reset());
      this.words = page.made("p", { class: "words" }, row);
      this.ghost = new page.Ghost(player);
      for (const kind of ["change", "commit"]) this.design.on(kind, () => this.follow());
      this.follow();
      document.addEventListener("keydown", (event) => this.key(event), { signal: player.signal });
      player.atEnd(() => row.remove());
    }
    button(text, row, act) {
      const button = page.made("button", { type: "button" }, row);
      button.textContent = text;
      button.addEventListener("click", () => {
        act();
        // a button that has nothing more to do cannot keep the keyboard
        if (button.disabled) [this.undo, this.redo, this.reset].find((other) => !other.disabled)?.focus();
      });
      return button;
    }
    key(event) {
      if (!event.target.closest?.(TYPED)) this.way(event);
    }
    // keys that lead back and on again, from where they mean no text that is being typed
    way(event) {
      if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
      const key = event.key.toLowerCase();
      if (key !== "z" && (key !== "y" || event.shiftKey)) return;
      event.preventDefault();
      if (this.player.drag && this.player.drag.held) this.player.drag.takeBack();
      else if (key === "z" && !event.shiftKey) this.design.undo();
      else this.design.redo();
    }
    // where it cannot be assembled, in words
    gaps() {
      const { gaps, name, count } = this.design.assembly;
      if (!gaps.length) return [];
      if (!count) return ["It cannot be assembled at any pose."];
      const told = gaps.length > MOST_GAPS ? [...gaps.slice(0, MOST_GAPS), "more"] : gaps;
      return [`It cannot be assembled at ${name} ${told.join(", ")}.`];
    }
    follow() {
      const { design, player } = this, { isChanged } = design;
      const put = (button, off) => { if (button.disabled !== off) button.disabled = off; };
      put(this.undo, !(design.canUndo || isChanged));
      put(this.redo, !design.canRedo);
      put(this.reset, !isChanged);
      const told = isChanged ? ["Dimensions are changed.", ...this.gaps(), ...(player.data.forces && !player.overlays.forces.isLive ? [FORCES] : [])].join(" ") : HINT;
      if (this.words.textContent !== told) this.words.textContent = told;
      this.ghost.follow();
    }
  }

  page.History = History;
  page.attach((player) => { if (player.design) player.history = new History(player); });
})();
