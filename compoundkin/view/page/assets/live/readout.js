// What is told while something is dragged: numbers beside it, the lines that it was drawn to, words for screen readers.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MOST = 5; // lengths told; more would hide the sketch
  const BESIDE = 18; // pixels from a handle to the numbers
  const HIGH = 150; // nearer to the top than this they have no room above it

  class Readout {
    constructor(handles) {
      this.handles = handles;
      const { player } = handles;
      this.box = page.made("div", { class: "numbers", "aria-hidden": "true", hidden: "" }, handles.layer);
      // a toolbar holds buttons only: words are told beside it
      this.spoken = page.made("p", { class: "unseen spoken", role: "status" }, player.root);
      this.lines = page.drawn("g", { class: "snaps", "data-tool": "" }, player.svg);
      this.text = "";
    }
    // `found` is where it was put and what drew it there, `lengths` lines of text
    show(one, { at, lines }, lengths) {
      const { player } = this.handles, { unit } = player.data;
      const [x, y] = at ? at.map((value) => Number(value.toPrecision(5))) : [];
      const head = at ? `${one.name}  ${page.written(x)}, ${page.withUnit(y, unit)}` : one.name;
      const told = lengths.length > MOST ? lengths.slice(0, MOST) : lengths;
      this.text = [head.replace("  ", " "), ...told].join("; ");
      this.box.replaceChildren(...[head, ...told].map((text, k) => {
        const line = document.createElement(k ? "span" : "strong");
        line.textContent = text;
        return line;
      }));
      this.box.hidden = false;
      this.lines.replaceChildren();
      for (const to of at ? lines : []) {
        const [x1, y1] = player.paper(to), [x2, y2] = player.paper(at);
        page.drawn("line", { x1, y1, x2, y2 }, this.lines);
      }
      this.put(at ? this.handles.toScreen(at) : one.at);
    }
    // beside it toward the middle, and above, where a finger hides nothing
    put([x, y]) {
      const isLeft = x < this.handles.width / 2, isLow = y > HIGH;
      const across = isLeft ? `${(x + BESIDE).toFixed(0)}px` : `calc(${(x - BESIDE).toFixed(0)}px - 100%)`;
      this.box.style.transform = `translate(${across},${isLow ? `calc(${(y - BESIDE).toFixed(0)}px - 100%)` : 0})`;
    }
    clear() {
      this.box.hidden = true;
      this.lines.replaceChildren();
    }
    // a region that says the same twice is read out once: so it is emptied first; while a key repeats, only the last is said
    say(text) {
      this.spoken.textContent = "";
      clearTimeout(this.waits);
      this.waits = setTimeout(() => { this.spoken.textContent = text; }, 200);
    }
  }

  page.Readout = Readout;
})();
