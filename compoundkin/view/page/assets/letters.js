// Names in the sketch: letters of points and numbers of links, which stay legible on small pictures. A letter stands where
// it was placed for the whole motion unless it is nearer to another point there: then it goes round its own at that pose.
(() => {
  "use strict";
  const page = window.compoundkin;
  // pixels for a picture unit: names are no smaller and no larger than at these (the smallest are 11 units high), but
  // at most so many times as large as they are drawn
  const LEGIBLE = 12.4 / 11, LARGE = 1.5, LARGEST = 6;
  const OF_LETTERS = 11 / 14; // the size of numbers to that of letters
  const WIDE = 4.4, TALL = 8, RIM = 9.5; // half a letter's width and height, and the circle around a number
  const SAME = 0.02; // sizes so near are one
  const CLEAR = 6; // from a point to the edge of its letter
  const FARTHEST = 17; // from its point, as drawn, the middle of a letter that stands beside it
  const AROUND = 16, RINGS = [1, 1.4, 2.4]; // places tried around a point: directions, and distances; the last has a line
  const LED = RINGS.length - 1;
  const APART = 1; // points nearer to each other are one for whoever reads
  const NEARER = 1.08; // by so much another point is to be farther than the letter's own
  // what a place costs: to be nearer to another point, to cover letters, numbers, points, to leave the picture, a line
  const WRONG = 1000, ON_LETTER = 300, ON_NUMBER = 200, ON_POINT = 120, OUTSIDE = 400, LINE = 150, TURNED = 6, RING = 12;
  const FAR = 23; // pixels from a point beyond which a line leads to its letter
  const DOT = 4; // half of a point as it is drawn

  // the box of a name as seen from the point it belongs to: its middle, half its width and height
  const box = (part) => {
    const text = part.querySelector("text");
    const [x, y] = ["x", "y"].map((name) => Number(text.getAttribute(name)));
    const round = part.querySelector("circle"), small = round ? 1 : OF_LETTERS;
    const wide = round ? RIM : Math.max(WIDE * text.textContent.length, text.getComputedTextLength() / 2);
    const texts = round ? [] : [...part.querySelectorAll("text")];
    return { x, y, wide, tall: round ? RIM : TALL, small, texts, letter: part.dataset.letter, shown: "", now: [x, y], line: null };
  };

  const far = (here, there) => Math.sqrt((here[0] - there[0]) ** 2 + (here[1] - there[1]) ** 2); // faster than hypot
  const AROUND_A_POINT = Array.from({ length: AROUND }, (_, k) => [Math.cos((2 * Math.PI * k) / AROUND), Math.sin((2 * Math.PI * k) / AROUND)]);

  class Letters {
    constructor(player) {
      this.player = player;
      this.boxes = player.parts.map((part) => (part.classList.contains("name") ? box(part) : null));
      this.size = 1; // so many times as large as they are drawn
      this.pixels = 1; // for a picture unit, as fit() or the first pose after a change of the view finds it
      this.isMeasured = false; // the browser lays the page out anew to measure: once for a view, not at each pose
      this.whole = 1; // the same where the picture is not enlarged
      this.fitted = 0; // pixels for a picture unit at the last fit
      this.leaders = page.drawn("g", { class: "leaders", "aria-hidden": "true", "data-tool": "" });
      player.svg.querySelector(".parts").before(this.leaders);
    }
    // on a small picture they are drawn larger; where it is enlarged they do not grow with it. Tells whether they changed.
    fit() {
      const { svg, base } = this.player;
      const pixelsOf = ({ width, height }) => Math.min(svg.clientWidth / width, svg.clientHeight / height);
      const grown = (pixels) => (pixels > 0 ? Math.min(LARGEST, Math.max(Math.min(1, LARGE / pixels), LEGIBLE / pixels)) : 1);
      this.isMeasured = false;
      const fitted = pixelsOf(svg.viewBox.baseVal), size = grown(fitted), whole = grown(pixelsOf(base));
      // a letter that is as large as before can be farther from its point, in pixels, and want a line to it
      if ([size - this.size, whole - this.whole, fitted - this.fitted].every((by) => Math.abs(by) < SAME)) return false;
      Object.assign(this, { size, whole, fitted });
      return true;
    }
    // letters are larger than numbers, and have to grow less
    grown(name) {
      return this.size > 1 ? Math.max(1, this.size * name.small) : this.size;
    }
    // --- where letters stand at a pose: their middles, by their parts -----------------------------------------------------
    // `seen` are the places on paper of all points, by letter; of those that are not known there is none
    place(numbers, seen) {
      const { player, boxes } = this, points = Object.entries(seen), put = [];
      this.measure();
      boxes.forEach((name, index) => {
        const own = name?.letter && seen[name.letter];
        if (!own || player.parts[index].classList.contains("missing")) return name?.letter && this.lead(name, null);
        const by = this.grown(name), drawn = Math.hypot(name.x, name.y);
        // what is farther than this from the point matters at no place that is tried
        const wide = by * name.wide, tall = by * name.tall, away = Math.max(by * drawn, RINGS[LED] * by * Math.max(CLEAR + Math.hypot(name.wide, name.tall), 11));
        const reach = (1 + NEARER) * away + DOT, others = [];
        for (const [letter, at] of points) {
          const between = letter === name.letter ? 0 : far(at, own);
          if (between > APART && between < reach) others.push(at);
        }
        const meets = (one) => Math.abs(one.x - own[0]) < away + wide + one.wide && Math.abs(one.y - own[1]) < away + tall + one.tall;
        const held = { name, own, by, others, numbers: numbers.filter(meets), put: put.filter(meets) };
        const kept = this.offer(held, by * name.x, by * name.y, drawn > FARTHEST ? 1 : 0);
        let best = kept;
        if (kept.cost >= RING) {
          for (let ring = 0; ring < RINGS.length && best.cost > ring * RING; ring++) {
            for (const [c, s] of AROUND_A_POINT) {
              const away = RINGS[ring] * by * Math.max(CLEAR + Math.min(name.wide / Math.max(Math.abs(c), 1e-9), name.tall / Math.max(Math.abs(s), 1e-9)), 11);
              const turned = 1 - (c * name.x + s * name.y) / (drawn || 1), led = ring === LED;
              const one = this.offer(held, away * c, away * s, ring, led ? LINE : 0, TURNED * turned);
              if (one.cost < best.cost) best = one;
            }
          }
        }
        put.push({ x: best.x, y: best.y, wide: by * name.wide, tall: by * name.tall });
        this.write(name, best, own, by);
      });
    }
    // until the view changes: its size, what is seen of the picture
    measure() {
      if (this.isMeasured) return;
      this.pixels = this.player.svg.getScreenCTM()?.a || this.pixels;
      this.isMeasured = true;
    }
    // what a place of a letter costs
    offer({ name, own, by, others, numbers, put }, dx, dy, ring, line = 0, turned = 0) {
      const x = own[0] + dx, y = own[1] + dy, wide = by * name.wide, tall = by * name.tall, { left, top, width, height } = this.player.room;
      let cost = ring * RING + turned + line;
      const away = Math.hypot(dx, dy);
      let nearest = Infinity;
      for (const at of others) nearest = Math.min(nearest, far(at, [x, y]));
      // who follows a line needs no distance
      if (nearest < away * NEARER) cost += line ? ON_POINT : WRONG * (1 + (away * NEARER - nearest) / away);
      for (const at of others) if (Math.abs(at[0] - x) < wide + DOT && Math.abs(at[1] - y) < tall + DOT) cost += ON_POINT;
      for (const one of numbers) if (Math.abs(one.x - x) < wide + one.wide && Math.abs(one.y - y) < tall + one.tall) cost += ON_NUMBER;
      for (const one of put) if (Math.abs(one.x - x) < wide + one.wide && Math.abs(one.y - y) < tall + one.tall) cost += ON_LETTER;
      if (x - wide < left || x + wide > left + width || y - tall < top || y + tall > top + height) cost += OUTSIDE;
      return { x, y, dx, dy, cost, isLed: line > 0 || nearest < away || away * this.pixels > FAR };
    }
    write(name, { dx, dy, x, y, isLed }, own, by) {
      const at = `${(dx / by).toFixed(2)} ${(dy / by).toFixed(2)}`;
      if (at !== name.shown) {
        const [px, py] = at.split(" ");
        for (const text of name.texts) { text.setAttribute("x", px); text.setAttribute("y", py); }
        Object.assign(name, { shown: at, now: [Number(px), Number(py)] });
      }
      this.lead(name, isLed ? [x - (dx / Math.hypot(dx, dy)) * by * name.tall, y - (dy / Math.hypot(dx, dy)) * by * name.tall, ...own] : null);
    }
    // the line from a letter to its point
    lead(name, ends) {
      if (!ends) {
        if (name.line) name.line.remove();
        name.line = null;
        return;
      }
      name.line ??= page.drawn("line", { class: "ck-lead" }, this.leaders);
      ["x1", "y1", "x2", "y2"].forEach((key, k) => name.line.setAttribute(key, ends[k].toFixed(2)));
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
