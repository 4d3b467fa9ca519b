// A driver that is held: the pose of the motion follows it; of several drivers, its own value does.
(() => {
  "use strict";
  const page = window.compoundkin;
  const TURN = 2 * Math.PI, DEGREE = 180 / Math.PI;
  const wrapped = (angle) => angle - TURN * Math.round(angle / TURN);

  class DriverHold {
    constructor(drag, one) {
      const { player } = drag;
      Object.assign(this, { drag, one, player, pose: player.pose, begun: null, moved: 0 });
      this.index = player.data.live.drives.findIndex(({ name }) => name === one.name);
      this.values = player.design.path.drives[this.index][0];
      this.isAlone = player.drivers.length === 1;
    }
    move(world) {
      this.change(this.wanted(world));
    }
    step(way, by) {
      const sign = way[0] + way[1];
      if (this.isAlone) {
        const { poses, pose } = this.player, to = pose + sign * Math.max(1, Math.round(by));
        this.player.show(((to % poses) + poses) % poses);
        this.tell();
      } else this.change(this.one.data.turns ? (sign * by) / DEGREE : sign * by * page.gridStep(this.drag.handles.pixel));
    }
    // how much more its value is where its link follows the pointer
    wanted(world) {
      const { player } = this, { link, at, turns } = this.one.data, k = player.pose, pivot = player.place(at);
      if (turns) {
        const pointed = Math.atan2(world[1] - pivot[1], world[0] - pivot[0]) - player.links[link].angle[k];
        this.begun ??= pointed;
        return wrapped(pointed - this.begun);
      }
      this.way ??= this.direction(k);
      const along = this.way[0] * (world[0] - pivot[0]) + this.way[1] * (world[1] - pivot[1]);
      this.begun ??= along;
      return along - this.begun;
    }
    // in which direction a slide goes when its value grows: as along the motion, or along the link itself
    direction(k) {
      const { link, on, at } = this.one.data, angle = this.player.links[link].angle[k], found = page.guideOf(this.player, on, at, k);
      if (!found || this.values[found.to] === this.values[k]) return [Math.cos(angle), Math.sin(angle)];
      return this.values[found.to] > this.values[k] ? found.along : found.along.map((part) => -part);
    }
    // the pose of the motion that is nearest; of several drivers, this one's own value
    change(by) {
      const { player, values } = this;
      if (this.isAlone) {
        const round = this.one.data.turns && player.data.closes ? wrapped : (away) => away, target = values[player.pose] + by;
        let best = player.pose, least = Infinity;
        for (let k = 0; k < values.length; k++) {
          const away = Math.abs(round(values[k] - target)) + 1e-9 * Math.abs(k - player.pose);
          if (away < least) [least, best] = [away, k];
        }
        player.show(best);
      } else {
        this.drag.free.move(this.index, by);
        this.moved += by;
      }
      this.tell();
    }
    tell() {
      const told = this.player.drivers.find(({ name }) => name === this.one.name);
      this.drag.numbers.show(this.one, { at: null, lines: [] }, [page.withUnit(told.parts[""][this.player.pose], told.unit)]);
    }
    drop() {}
    takeBack() {
      if (this.isAlone) this.player.show(this.pose);
      else if (this.moved) this.drag.free.move(this.index, -this.moved);
    }
  }

  page.DriverHold = DriverHold;
})();
