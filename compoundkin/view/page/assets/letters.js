// Names in the sketch: letters of points and numbers of links, which stay legible on small pictures.
(() => {
  "use strict";
  const page = window.compoundkin;
  // pixels for a picture unit: names are no smaller and no larger than at these (the smallest are 11 units high), but
  // at most so many times as large as they are drawn
  const LEGIBLE = 12.4 / 11, LARGE = 1.5, LARGEST = 6;
  const OF_LETTERS = 11 / 14; // the size of numbers to that of letters
  const WIDE = 4.4, TALL = 8, RIM = 9.5; // half a letter's width and height, and the circle around a number
  const SAME = 0.02; // sizes so near are one

  // the box of a name as seen from the point it belongs to: its middle, half its width and height
  const box = (part) => {
    const text = part.querySelector("text");
    const [x, y] = ["x", "y"].map((name) => Number(text.getAttribute(name)));
    const round = part.querySelector("circle"), small = round ? 1 : OF_LETTERS;
    return { x, y, wide: round ? RIM : Math.max(WIDE * text.textContent.length, text.getComputedTextLength() / 2), tall: round ? RIM : TALL, small };
  };

  class Letters {
    constructor(player) {
      this.player = player;
      this.boxes = player.parts.map((part) => (part.classList.contains("name") ? box(part) : null));
      this.size = 1; // so many times as large as they are drawn
      this.whole = 1; // the same where the picture is not enlarged
    }
    // on a small picture they are drawn larger; where it is enlarged they do not grow with it. Tells whether they changed.
    fit() {
      const { svg, base } = this.player;
      const grown = ({ width, height }) => {
        const pixels = Math.min(svg.clientWidth / width, svg.clientHeight / height);
        return pixels > 0 ? Math.min(LARGEST, Math.max(Math.min(1, LARGE / pixels), LEGIBLE / pixels)) : 1;
      };
      const size = grown(svg.viewBox.baseVal), whole = grown(base);
      if (Math.abs(size - this.size) < SAME && Math.abs(whole - this.whole) < SAME) return false;
      Object.assign(this, { size, whole });
      return true;
    }
    // letters are larger than numbers, and have to grow less
    grown(name) {
      return this.size > 1 ? Math.max(1, this.size * name.small) : this.size;
    }
    // where a name that has grown is put, so that it stays in the picture
    within([x, y], name) {
      const { left, top, width, height } = this.player.room, by = this.grown(name);
      const held = (at, off, half, from, size) => Math.max(from + by * half, Math.min(from + size - by * half, at + by * off)) - by * off;
      return [held(x, name.x, name.wide, left, width), held(y, name.y, name.tall, top, height)];
    }
  }

  page.Letters = Letters;
})();
