// What can be shown over the sketch: vectors and forces with their scales, paths of points, instant centres.
(() => {
  "use strict";
  const page = window.compoundkin;
  const SCALE = 18; // the height of the line that tells a scale of vectors
  const VECTORS = [["velocity", 1, "velocities"], ["acceleration", 2, "accelerations"]];
  const LAYERS = ["traces", "rays", "velocities", "accelerations", "forces", "dots"];
  const HEAD = 10, HALF = 3.6; // an arrow's head, as in every other picture

  class Overlays {
    constructor(player) {
      const { svg, data } = player;
      Object.assign(this, { player, data, shown: new Set(["names"]) });
      this.layers = Object.fromEntries(LAYERS.map((name) => [name, svg.querySelector(`.${name}`)]));
      this.centres = new page.CentreOverlay(this);
      this.forces = new page.ForceOverlay(this);
    }
    get isChanged() {
      return Boolean(this.player.design?.isChanged);
    }
    get vectors() {
      return VECTORS.filter(([kind]) => this.shown.has(kind) && this.data.vectors[kind]);
    }

    // --- the room that they take ----------------------------------------------------------------------------------------
    // a box of the picture that holds the tips of all arrows at any pose, too
    around(box) {
      let [left, top, right, bottom] = box;
      for (const [[x, y], [dx, dy]] of this.arrows()) {
        if (!Number.isFinite(x + y + dx + dy)) continue;
        left = Math.min(left, x + dx - HALF);
        right = Math.max(right, x + dx + HALF);
        top = Math.min(top, y + dy - HALF);
        bottom = Math.max(bottom, y + dy + HALF);
      }
      return [left, top, right, bottom];
    }
    // where each arrow begins and which way it goes, on the picture
    *arrows() {
      const { player } = this;
      for (const [kind, order] of this.vectors) {
        for (const letter in player.points) for (let k = 0; k < player.poses; k++) yield this.vector(letter, kind, order, k);
      }
      if (this.forces.isShown) yield* this.forces.arrows();
    }
    // so high are the scales below the picture
    get below() {
      return (this.vectors.length + (this.forces.isShown ? this.forces.keys.length : 0)) * SCALE;
    }

    // --- drawn at the pose that is shown ----------------------------------------------------------------------------------
    draw() {
      const { player, layers, shown } = this, isKnown = player.assembled[player.pose] === 1;
      for (const name of LAYERS) if (name !== "traces") layers[name].replaceChildren();
      if (!isKnown) return;
      for (const [kind, order, layer] of this.vectors) this.drawVectors(kind, order, layers[layer]);
      if (this.forces.isShown) this.forces.draw();
      if (shown.has("centres")) this.centres.draw();
    }
    vector(letter, kind, order, k = this.player.pose) {
      const { player } = this, { scale } = this.data.vectors[kind], [vx, vy] = player.rate(letter, order, k);
      return [player.paper(player.place(letter, k)), [vx * scale, -vy * scale]];
    }
    drawVectors(kind, order, layer) {
      const scale = this.data.vectors[kind];
      for (const letter in this.player.points) {
        const [at, way] = this.vector(letter, kind, order);
        if (Math.hypot(...way) >= scale.shortest) this.arrow(at, way, kind, layer);
      }
      const isAbove = kind === "acceleration" && this.shown.has("velocity");
      this.key(kind, `${kind}, ${scale.text}`, scale.length, isAbove ? 1.5 : 0.5, layer);
    }
    // an arrow with what it says, so many rows above the lower edge; words alone where it has no length
    key(kind, words, long, rows, layer) {
      const { left, top, height } = this.player.room, x = left + 12, y = top + height - rows * SCALE * this.player.letters.size;
      if (long) this.arrow([x, y], [long, 0], kind, layer);
      this.text(words, long ? x + 8 + long : x, y, "ck-note", "start", layer);
    }
    text(words, x, y, style, anchor, layer) {
      const { size } = this.player.letters, grown = size !== 1 ? ` scale(${size})` : "";
      page.drawn("text", { class: style, transform: `translate(${x} ${y})${grown}`, dy: "0.35em", "text-anchor": anchor }, layer).textContent = words;
    }
    arrow([x, y], [dx, dy], kind, layer) {
      const length = Math.hypot(dx, dy), ex = dx / length, ey = dy / length, head = Math.min(HEAD, 0.6 * length);
      const tip = [x + dx, y + dy], back = [tip[0] - ex * head, tip[1] - ey * head], half = (HALF * head) / HEAD;
      page.drawn("path", { class: `ck-${kind}`, d: `M${x} ${y}L${tip[0] - ex * head * 0.8} ${tip[1] - ey * head * 0.8}` }, layer);
      const sides = `L${back[0] - ey * half} ${back[1] + ex * half}L${back[0] + ey * half} ${back[1] - ex * half}Z`;
      page.drawn("path", { class: `ck-${kind}-head`, d: `M${tip[0]} ${tip[1]}${sides}` }, layer);
    }

    // --- paths, which are the same at every pose --------------------------------------------------------------------------
    trace() {
      const { player, layers } = this;
      layers.traces.replaceChildren();
      for (const letter in player.points) {
        if (!this.shown.has(`path ${letter}`)) continue;
        let d = "", on = false;
        for (let k = 0; k < player.poses; k++) {
          const known = player.assembled[k] === 1;
          if (known) d += `${on ? "L" : "M"}${player.paper(player.place(letter, k)).map((c) => c.toFixed(2)).join(" ")}`;
          on = known;
        }
        page.drawn("path", { class: "ck-path", d }, layers.traces);
      }
    }
  }

  page.Overlays = Overlays;
})();
