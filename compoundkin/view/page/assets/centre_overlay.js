// Instant centres over the sketch: dots with their names, and the lines that give them.
(() => {
  "use strict";
  const page = window.compoundkin;
  const FAR = 1e5; // picture units: beyond, a place is a direction
  const DOT = 3.2;
  const TOGETHER = 3; // centres nearer to each other are named together
  const HALF_LETTER = 3.4; // of a name, along it
  const ROUNDING = 1e-9; // parts of the rates below which a difference is rounding

  // The pole of links i and j of a changed mechanism at pose k, from their velocities: homogeneous (x, y, w), as the page's own
  // are. w is zero at infinity; all are NaN where neither moves against the other.
  const pole = (links, i, j, k, size) => {
    // the velocity of what is at the origin, and the rate of turning
    const rate = ({ x, y, v }) => (v ? [v[0][k] + v[2][k] * y[k], v[1][k] - v[2][k] * x[k], v[2][k]] : [NaN, NaN, NaN]);
    const one = rate(links[i]), other = rate(links[j]);
    const [ax, ay, w] = one.map((value, part) => other[part] - value);
    const fastest = (part) => Math.max(...[one, other].map((it) => Math.abs(it[part])));
    const still = ROUNDING * Math.max(size * fastest(2), fastest(0), fastest(1));
    const turns = Math.abs(w) * size > still;
    if (!turns && Math.hypot(ax, ay) <= still) return [NaN, NaN, NaN];
    return [-ay, ax, turns ? w : 0];
  };

  class CentreOverlay {
    constructor(overlays) {
      Object.assign(this, { overlays, player: overlays.player, dots: overlays.layers.dots, rays: overlays.layers.rays });
    }
    draw() {
      const { player, overlays } = this, { centres, data } = player, { width, height } = data.window;
      const places = centres.map((centre) => this.place(centre));
      const inside = (p) => p && !p.far && p.x >= 0 && p.y >= 0 && p.x <= width && p.y <= height;
      for (const [own, ...through] of data.lines) if (inside(places[own])) this.ray([own, ...through].map((k) => places[k]));
      const named = [];
      centres.forEach(({ name }, k) => {
        const p = places[k];
        if (!inside(p)) return;
        const same = named.find((other) => Math.hypot(other.x - p.x, other.y - p.y) < TOGETHER);
        if (same) same.names.push(name);
        else named.push({ ...p, names: [name] });
      });
      const taken = overlays.shown.has("names") ? this.taken() : [];
      for (const one of named) this.name(one, taken);
      const gone = centres.filter((_, k) => places[k] && places[k].far).map(({ name }) => name);
      if (gone.length) overlays.text(`at infinity: ${gone.join(", ")}`, 12, 12, "ck-note", "start", this.dots);
    }
    // where a centre is on the picture, or which way it is; null where there is none
    place(centre) {
      const { player, overlays } = this;
      const [x, y, w] = overlays.isChanged || !centre.at ? this.pole(centre) : centre.at.map((values) => values[player.pose]);
      if (!Number.isFinite(x + y + w)) return null;
      const [px, py] = player.paper([x / w, y / w]);
      const near = Math.abs(px) < FAR && Math.abs(py) < FAR;
      return near ? { x: px, y: py } : { far: [x / Math.hypot(x, y), -y / Math.hypot(x, y)] };
    }
    // the centre of a changed mechanism, one that does not depend on how quick the drivers are
    pole({ links, at }) {
      if (at && !at.some((values) => values.some(Number.isFinite))) return [NaN, NaN, NaN];
      const { player } = this, { width, scale } = player.data.window;
      const [i, j] = links.map((name) => player.data.links.findIndex((link) => link.name === name));
      return pole(player.links, i, j, player.pose, width / scale);
    }

    // --- names ------------------------------------------------------------------------------------------------------------
    name({ x, y, names }, taken) {
      page.drawn("circle", { class: "ck-centre", cx: x, cy: y, r: DOT }, this.dots);
      const text = names.join(" "), at = this.beside(x, y, HALF_LETTER * text.length * this.player.letters.size, taken);
      taken.push(at);
      for (const style of ["ck-halo ck-centre-name", "ck-centre-name"]) this.overlays.text(text, at.x, at.y, style, "middle", this.dots);
    }
    // where the letters and numbers of the sketch are: boxes by their middle and half their width
    taken() {
      const { parts, letters } = this.player, { boxes, size } = letters;
      return parts.flatMap((part, index) => {
        const name = boxes[index];
        if (!name) return [];
        const [x, y] = part.getAttribute("transform").match(/-?[\d.]+(e[+-]?\d+)?/g).map(Number);
        const [dx, dy] = name.now;
        return { x: x + dx * size, y: y + dy * size, half: name.wide * size };
      });
    }
    // a place for a name of that half width beside a point: the first that covers none, or the one that covers fewest
    beside(x, y, half, taken) {
      const { letters: { size }, data } = this.player, { width, height } = data.window;
      let best = null;
      for (const far of [0, 8, 18]) {
        for (const [ex, ey] of [[1, 1], [1, -1], [-1, 1], [-1, -1], [0, 1], [0, -1]]) {
          const at = { x: x + ex * (half + 6 + far), y: y + ey * (5 + 6 * size + far), half };
          const out = at.x < half || at.x > width - half || at.y < 6 || at.y > height - 6;
          const covers = taken.filter((one) => Math.abs(one.x - at.x) < one.half + half && Math.abs(one.y - at.y) < 13 * size).length;
          at.cost = covers + 10 * out;
          if (!best || at.cost < best.cost) best = at;
          if (!best.cost) return best;
        }
      }
      return best;
    }

    // a line through centres: as long as they reach, or across the picture where one is at infinity
    ray(places) {
      const near = places.filter((p) => p && !p.far), far = places.find((p) => p && p.far);
      if (!near.length || (near.length < 2 && !far)) return;
      let [a, b] = [near[0], near[0]];
      if (far) {
        const { width, height } = this.player.data.window, reach = 2 * Math.hypot(width, height);
        a = { x: a.x - far.far[0] * reach, y: a.y - far.far[1] * reach };
        b = { x: b.x + far.far[0] * reach, y: b.y + far.far[1] * reach };
      } else {
        const farthest = (from) => near.reduce((best, p) => (Math.hypot(p.x - from.x, p.y - from.y) > Math.hypot(best.x - from.x, best.y - from.y) ? p : best), from);
        a = farthest(near[0]);
        b = farthest(a);
      }
      page.drawn("path", { class: "ck-ray", d: `M${a.x} ${a.y}L${b.x} ${b.y}` }, this.rays);
    }
  }

  page.CentreOverlay = CentreOverlay;
})();
