// The design: the numbers of the dimensions, what is computed of them, and the way back. Who follows a change listens here.
(() => {
  "use strict";
  const page = window.compoundkin;
  const MOST_STEPS = 200; // of undo
  const KEPT = 4e6; // numbers of computed motions that the history may hold; older ones are computed again

  const assembled = ({ assembled: poses }) => poses.reduce((sum, one) => sum + one, 0);

  class Design {
    // `player` shows what `path` computes
    constructor(player, path) {
      Object.assign(this, { player, path, names: path.names, own: path.own });
      this.index = new Map(path.names.map((name, k) => [name, k]));
      this.numbers = Float64Array.from(path.own);
      this.carried = this.byLetter(player.data.live.dimensions);
      this.listeners = { change: [], commit: [] };
      this.wanted = null; // what the next picture shall show
      this.at = 0; // the step of the history that it is, or was before what was changed since
      player.atEnd(() => cancelAnimationFrame(this.frame));
    }

    // computed when it is first asked for: most who read a page change nothing
    get original() {
      return (this.computed ??= this.path.solved(this.own, null));
    }
    get solved() {
      return this.current || this.original;
    }
    // from where configurations are followed to other dimensions: through a gap they are lost, so that who comes back
    // from one shall find what was there before
    get near() {
      const { solved } = this, before = this.history[this.at].solved;
      return before && assembled(before) > assembled(solved) ? before : solved;
    }
    get history() {
      return (this.steps ??= [{ numbers: Float64Array.from(this.own), solved: this.original, words: "" }]);
    }
    get isChanged() {
      return this.numbers.some((value, k) => value !== this.own[k]);
    }

    // --- what it is ---------------------------------------------------------------------------------------------------
    value(name) {
      return this.numbers[this.index.get(name)];
    }
    // the point on every link whose coordinates of it can be changed: in the link's own frame
    point(letter) {
      const found = this.carried.get(letter) || [];
      return found.map(({ link, x, y }) => ({ link, x: this.numbers[x], y: this.numbers[y] }));
    }
    // why the pose shown cannot be assembled, in words
    why(k = this.player.pose) {
      const found = this.path.why(this.numbers, this.solved, k);
      return found ? `${found.group}: ${found.text}` : "";
    }
    // the points of a link by letter, in its own frame: those that change and those that are fixed
    pointsOn(link) {
      const found = new Map(Object.entries(this.player.data.live.panel?.fixed[link] || {}));
      for (const [letter, carried] of this.carried) {
        const own = carried.find((one) => one.link === link);
        if (own) found.set(letter, [this.numbers[own.x], this.numbers[own.y]]);
      }
      return found;
    }
    // how many poses are assembled, and along what the others are
    get assembly() {
      const { assembled } = this.solved, { along, poses, data } = this.player, gaps = [];
      for (let k = 0; k < poses; k++) {
        if (assembled[k] === 1) continue;
        const last = gaps.at(-1);
        if (last && last[1] === k - 1) last[1] = k;
        else gaps.push([k, k]);
      }
      const told = (k) => page.withUnit(along.name === "pose" ? k + 1 : along.values[k], along.name === "pose" ? "" : along.unit);
      const words = gaps.map(([a, b]) => (a === b ? told(a) : `${told(a)} to ${told(b)}`));
      return { count: poses - gaps.reduce((sum, [a, b]) => sum + b - a + 1, 0), poses, isAll: data.all === poses, gaps: words, name: along.name };
    }
    // of a pose that is not assembled: where the links are that are known, and circles of the group that fails
    partial(k) {
      const { path, numbers, solved, player } = this, known = path.partial(numbers, solved, k, player.data.links.map(({ name }) => name)), index = new Map(player.data.links.map(({ name }, n) => [name, n]));
      const group = path.data.groups[solved.failed[k] - 1], own = group && !group.guide ? group.links : [], circles = [];
      const at = (link, [x, y]) => {
        const { x: [ox], y: [oy], angle: [angle] } = known[link], c = Math.cos(angle), s = Math.sin(angle);
        return [ox + c * x - s * y, oy + s * x + c * y];
      };
      const points = new Map(player.data.links.map(({ name }) => [name, this.pointsOn(name)]));
      const carriers = (letter, isKnown) => [...points].filter(([name, has]) => has.has(letter) && index.has(name) && Boolean(known[index.get(name)]) === isKnown).map(([name]) => name);
      for (const name of own) {
        const letters = [...(points.get(name) || [])];
        for (const [outer, from] of letters) {
          const [carrier] = carriers(outer, true);
          if (!carrier) continue;
          for (const [inner, to] of letters) {
            if (inner === outer || carriers(inner, true).length || !carriers(inner, false).some((other) => other !== name && own.includes(other))) continue;
            circles.push({ link: name, middle: at(index.get(carrier), points.get(carrier).get(outer)), radius: Math.hypot(to[0] - from[0], to[1] - from[1]) });
          }
        }
      }
      const place = (letter) => {
        const [carrier] = carriers(letter, true);
        return carrier ? at(index.get(carrier), points.get(carrier).get(letter)) : null;
      };
      return { known, circles, place };
    }
    // by letters: the links, and which numbers the two coordinates are
    byLetter(dimensions) {
      const found = new Map();
      dimensions.forEach(({ name, owner, word, part, kind }) => {
        const base = name.slice(0, -2);
        if (kind !== "point" || part !== "x" || !this.index.has(`${base}.y`)) return;
        if (!found.has(word)) found.set(word, []);
        found.get(word).push({ link: owner, base, x: this.index.get(name), y: this.index.get(`${base}.y`) });
      });
      return found;
    }

    // --- change: seen at once, no step of its own yet -----------------------------------------------------------------
    change(values) {
      const numbers = Float64Array.from(this.numbers);
      for (const [name, value] of Object.entries({ ...this.wanted, ...values })) {
        if (this.index.has(name) && Number.isFinite(value)) numbers[this.index.get(name)] = value;
      }
      this.wanted = null;
      this.take(numbers, null);
    }
    // the same, once for each picture that the screen shows, however often a pointer tells
    soon(values) {
      const waits = this.wanted;
      this.wanted = { ...this.wanted, ...values };
      if (!waits) this.frame = requestAnimationFrame(() => this.settle());
    }
    settle() {
      if (this.wanted) this.change({});
    }
    take(numbers, solved) {
      if (numbers.every((value, k) => value === this.numbers[k])) return;
      const { near } = this; // asked before the numbers are others: the first step is the original
      this.numbers = numbers;
      this.current = this.isChanged ? solved || this.path.solved(numbers, near) : this.original;
      this.player.take(this.isChanged ? this.current : null);
      this.tell("change");
    }

    // --- steps, and the way back --------------------------------------------------------------------------------------
    commit(words) {
      this.settle();
      const { history } = this, before = history[this.at].numbers;
      if (this.numbers.every((value, k) => value === before[k])) return;
      history.length = this.at + 1;
      history.push({ numbers: this.numbers, solved: this.solved, words });
      if (history.length > MOST_STEPS) history.shift();
      this.at = history.length - 1;
      this.thin();
      this.tell("commit");
    }
    thin() {
      const each = this.player.poses * Math.max(1, this.player.links.length) * 9;
      const most = Math.max(2, Math.floor(KEPT / each));
      this.history.forEach((step, k) => { if (k && Math.abs(this.at - k) > most) step.solved = null; });
    }
    undo() {
      this.commit("");
      return this.go(this.at - 1);
    }
    redo() {
      this.commit("");
      return this.go(this.at + 1);
    }
    // to a step of the history; tells whether there is such a one
    go(at) {
      const step = this.history[at];
      if (!step) return false;
      this.at = at;
      this.take(Float64Array.from(step.numbers), step.solved);
      step.solved = this.solved;
      this.tell("commit");
      return true;
    }
    // what was changed since the last step is taken back
    revert() {
      this.wanted = null;
      const step = this.history[this.at];
      this.take(Float64Array.from(step.numbers), step.solved);
    }
    reset() {
      this.load({}, "original dimensions");
    }
    // these numbers, all others as they were made
    load(values, words) {
      this.wanted = null;
      const numbers = Float64Array.from(this.own);
      for (const [name, value] of Object.entries(values)) {
        if (this.index.has(name) && Number.isFinite(value)) numbers[this.index.get(name)] = value;
      }
      this.take(numbers, null);
      this.commit(words);
    }
    get canUndo() { return this.at > 0; }
    get canRedo() { return Boolean(this.steps) && this.at < this.steps.length - 1; }

    // --- who listens --------------------------------------------------------------------------------------------------
    on(kind, heard) {
      this.listeners[kind].push(heard);
    }
    tell(kind) {
      for (const heard of this.listeners[kind]) heard(this);
    }
  }

  page.Design = Design;
  page.attach((player) => {
    const { live } = player.data;
    player.design = live && !live.why ? new Design(player, player.path) : null;
  });
})();
