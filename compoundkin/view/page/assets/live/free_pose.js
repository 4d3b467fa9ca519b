// A pose beside the motion: of several drivers one has another value. It stands in place of the pose shown until another is.
(() => {
  "use strict";
  const page = window.compoundkin;
  const DEGREE = 180 / Math.PI;

  class FreePose {
    constructor(player) {
      this.player = player;
      this.kept = null;
      player.listeners.push((k) => { if (this.kept && k !== this.kept.k) this.leave(); });
      player.design.on("change", () => { if (this.kept) this.again(); });
    }
    // the arrays that tell poses, each with what is told of a pose beside the motion
    *told({ assembled, links, outputs }, drives) {
      const { player } = this, inUnit = (unit) => (unit === "deg" ? DEGREE : 1);
      yield [player.assembled, Number(assembled)];
      for (const [index, link] of player.links.entries()) {
        for (const key of ["x", "y", "angle"]) yield [link[key], links[index][key]];
        for (const key of ["v", "a"]) for (const [part, values] of (link[key] || []).entries()) yield [values, links[index][key] ? links[index][key][part] : NaN];
      }
      for (const { name, unit, parts } of player.outputs) for (const part in parts) yield [parts[part], outputs[name] ? outputs[name][part] * inUnit(unit) : NaN];
      for (const { name, unit, parts } of player.drivers) {
        const index = player.data.live.drives.findIndex((drive) => drive.name === name);
        if (index >= 0) yield [parts[""], drives[index][0] * inUnit(unit)];
      }
    }
    // driver `index` has a value that is greater by so much
    move(index, by) {
      const { player } = this, { path } = player.design, k = player.pose;
      this.kept ??= { k, drives: path.drives.map((one) => one.map((values) => values[k])), before: new Map() };
      this.kept.drives[index][0] += by;
      this.put();
    }
    put() {
      const { player, kept } = this, { design } = player, { k, drives, before } = kept;
      const one = design.path.at(design.numbers, drives, design.solved, k);
      for (const [values, value] of this.told(one, drives)) {
        if (!before.has(values)) before.set(values, values[k]);
        values[k] = value;
      }
      player.showAgain();
    }
    // the motion has its pose back
    leave() {
      const { k, before } = this.kept;
      for (const [values, value] of before) values[k] = value;
      this.kept = null;
    }
    // other dimensions: the motion's pose is another one, the drivers stay
    again() {
      const { k, before } = this.kept;
      for (const { parts } of this.player.drivers) if (before.has(parts[""])) parts[""][k] = before.get(parts[""]);
      before.clear();
      this.put();
    }
  }

  page.FreePose = FreePose;
})();
