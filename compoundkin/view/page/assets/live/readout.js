// What is told while something is dragged: numbers beside it, the lines that it was drawn to, words for screen readers.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MOST = 5; // lengths told; more would hide the sketch
  const BESIDE = 18; // pixels from a handle to the numbers
  const STEP = 0.1; // of a line between two points of a link: places that are not to be covered
  const AROUND = [[1, -1], [-1, -1], [1, 1], [-1, 1], [1, 0], [-1, 0], [0, -1], [0, 1]]; // where numbers may stand

  class Readout {
    constructor(handles) {
      this.handles = handles;
      const { player } = handles;
      this.box = page.made("div", { class: "numbers", "aria-hidden": "true", hidden: "" }, handles.layer);
      // a toolbar holds buttons only: words are told beside it
      this.spoken = page.made("p", { class: "unseen spoken", role: "status" }, player.root);
      this.lines = page.drawn("g", { class: "snaps", "data-tool": "" }, player.svg);
      this.text = "";
      player.atEnd(() => {
        clearTimeout(this.waits);
        for (const one of [this.spoken, this.lines]) one.remove();
      });
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
    // beside it where it covers least of the mechanism, and rather above, where a finger hides nothing
    put([x, y]) {
      const { offsetWidth: wide, offsetHeight: high } = this.box, { seen } = this.handles, covered = this.drawn();
      let best = null;
      for (const away of [BESIDE, 3 * BESIDE, 6 * BESIDE]) {
        for (const [across, down] of AROUND) {
          const left = x + across * away - (across < 0 ? wide : across ? 0 : wide / 2), top = y + down * away - (down < 0 ? high : down ? 0 : high / 2);
          const isOut = left < seen.left || top < seen.top || left + wide > seen.right || top + high > seen.bottom;
          const hits = covered.filter(([px, py]) => px > left - 4 && px < left + wide + 4 && py > top - 4 && py < top + high + 4).length;
          const cost = hits * 4 + (isOut ? 1000 : 0) + away / BESIDE + (down > 0 ? 1 : 0);
          if (!best || cost < best.cost) best = { left, top, cost };
        }
      }
      this.box.style.transform = `translate(${best.left.toFixed(0)}px,${best.top.toFixed(0)}px)`;
    }
    // places on the links, in pixels
    drawn() {
      const { player } = this.handles, found = [];
      player.data.links.forEach((_, link) => {
        const points = page.pointsOf(player, link).map((one) => this.handles.toScreen(player.at(link, one.x, one.y, player.pose)));
        points.forEach(([ax, ay], k) => points.slice(k).forEach(([bx, by]) => {
          for (let t = 0; t <= 1; t += STEP) found.push([ax + t * (bx - ax), ay + t * (by - ay)]);
        }));
      });
      return found;
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
