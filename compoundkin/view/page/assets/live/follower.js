// The follower: a body of one freedom whose contact with a profile is searched anew at each pose. Where its path crosses
// the sampled profile gives the coordinate nearly, Newton's steps to the nearest place of the profile exactly.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const STEPS = 40, APPROACH = 5, CLOSED = 1e-12; // of Newton; so many before the gap must halve; parts of the profile's size
  const NEAR = 1e-6, ALONG = 1e-9; // a face touches a sample (parts of the size); a face lies along its own guide

  // the angle of a vector, within half a turn of another one's
  const nearest = (x, y, mx, my) => Math.atan2(y * mx - x * my, x * mx + y * my) + Math.atan2(my, mx);

  class Follower {
    // `turns` is +1 where a closed profile goes counterclockwise, -1 clockwise, 0 for an open one; `outward` the side of
    // the profile's normal on which the follower is
    constructor(profile, { straight, sense, greatest, turns, outward, samples }, flat) {
      Object.assign(this, { profile, straight, sense, greatest, turns, outward, count: samples, flat });
      this.last = new WeakMap();
      this.slope = flat ? -turns : straight ? 0 : turns * sense;
    }
    // points of the profile and its normals there: those that a face can touch, else all
    get samples() {
      if (this.known) return this.known;
      const { profile, count, flat, turns } = this, [px, py, nx, ny] = [[], [], [], []];
      const size = Math.hypot(Math.max(...profile.sx) - Math.min(...profile.sx), Math.max(...profile.sy) - Math.min(...profile.sy));
      for (let k = 0; k < (profile.closed ? count : count + 1); k++) {
        const [x, y, dx, dy] = profile.at(profile.low + (k * profile.span) / count, 1), long = Math.hypot(dx, dy);
        const side = (flat ? turns || this.outward : 1) / long, normal = [dy * side, -dx * side];
        if (flat) {
          const [fx, fy] = profile.at(profile.touched(normal[0], normal[1], true), 0);
          if (Math.hypot(fx - x, fy - y) >= NEAR * size) continue;
        }
        [px, py, nx, ny].forEach((row, part) => row.push([x, y, ...normal][part]));
      }
      const mean = (row) => row.reduce((sum, one) => sum + one, 0) / row.length, middle = [mean(px), mean(py)];
      if (turns) for (const row of [px, py, nx, ny]) row.push(row[0]);
      return (this.known = { px, py, nx, ny, middle, levels: new Float64Array(px.length), size });
    }
    // how far samples are from what is sought, along the path: [start, centre, toward] by x and y
    levels([sx, sy, cx, cy, tx, ty]) {
      const { px, py, nx, ny, levels } = this.samples, { straight, flat } = this;
      const foot = tx * (sx - cx) + ty * (sy - cy), arm = (sx - cx) ** 2 + (sy - cy) ** 2;
      for (let k = 0; k < levels.length; k++) {
        if (flat) { levels[k] = nx[k] * (px[k] - cx) + ny[k] * (py[k] - cy) - foot; continue; }
        const x = px[k] + nx[k] * tx, y = py[k] + ny[k] * tx;
        levels[k] = straight ? cx * (y - sy) - cy * (x - sx) : (x - cx) ** 2 + (y - cy) ** 2 - arm;
      }
      return levels;
    }
    // the coordinate between a sample and the next; of a face on a pin without the sense of the path
    coordinate(k, share, [sx, sy, cx, cy, tx, ty]) {
      const { px, py, nx, ny, middle: [mx, my] } = this.samples, next = share ? k + 1 : k;
      const between = (row) => row[k] + share * (row[next] - row[k]);
      const [nX, nY] = [between(nx), between(ny)];
      if (this.flat) return nearest(nX * tx + nY * ty, nY * tx - nX * ty, (cx - mx) * tx + (cy - my) * ty, (cy - my) * tx - (cx - mx) * ty);
      const x = between(px) + nX * tx, y = between(py) + nY * tx;
      if (this.straight) return this.sense * (cx * (x - sx) + cy * (y - sy));
      const [ax, ay] = [sx - cx, sy - cy], seen = (gx, gy) => [gx * ax + gy * ay, gy * ax - gx * ay];
      return this.sense * nearest(...seen(x - cx, y - cy), ...seen(mx - cx, my - cy));
    }
    // the least or the greatest coordinate at which the path meets the profile
    outermost(path) {
      const levels = this.levels(path), count = levels.length - 1, sides = [];
      for (let k = 0; k < count; k++) if (levels[k] <= 0 !== levels[k + 1] <= 0) sides.push(k);
      if (!sides.length) return this.beside(levels, path);
      const last = sides.length - 1, around = this.turns !== 0 && sides[0] === 0 && sides[last] === count - 1;
      const found = sides.map((k, n) => {
        // two with one sample between them, near a limit position, are looked for from the samples beyond them
        const before = n ? sides[n - 1] === k - 1 : around, after = n < last ? sides[n + 1] === k + 1 : around;
        return this.coordinate(k, before === after ? levels[k] / (levels[k] - levels[k + 1]) : after ? 0 : 1, path);
      });
      // the only two on a circle, where there is no least one, are told apart by how the level goes
      if (found.length === 2 && this.slope) {
        const rises = sides.map((k) => Math.sign(levels[k + 1] - levels[k]) * this.slope), own = rises.indexOf(this.greatest ? -1 : 1);
        if (own >= 0) return found[own];
      }
      return this.greatest ? Math.max(...found) : Math.min(...found);
    }
    // where no level changes its sign: from a sample beside the one nearest to it
    beside(levels, path) {
      let at = 0;
      for (let k = 1; k < levels.length; k++) if (Math.abs(levels[k]) < Math.abs(levels[at])) at = k;
      const last = levels.length - 1, before = at > 0 ? at - 1 : this.turns ? last - 1 : 0, after = at < last ? at + 1 : this.turns ? 1 : last;
      const [one, other] = [this.coordinate(before, 0, path), this.coordinate(after, 0, path)];
      const slope = this.slope * (levels[at] <= 0 ? 1 : -1), first = slope === 0 ? one < other : slope > 0;
      return first === this.greatest ? other : one;
    }
    // the coordinate of the contact and the profile's parameter there, of a path past the profile at a machine's pose;
    // the same as when it was last asked, if the path is
    met(path, machine, pose) {
      if (!this.last.has(machine)) this.last.set(machine, []);
      const known = this.last.get(machine), last = known[pose];
      if (last && path.every((one, n) => one === last.path[n])) return last.found;
      const found = this.searched(path);
      known[pose] = { path, found };
      return found;
    }
    searched(path) {
      if (path.some((one) => one !== one)) return [NaN, NaN];
      const { profile, straight, flat, sense } = this, [sx, sy, cx, cy, tx, ty] = path, { size } = this.samples;
      if (straight && flat) {
        const s = profile.touched(tx, ty, true), [x, y] = profile.at(s, 0), rise = tx * cx + ty * cy;
        return [Math.abs(rise) < ALONG ? NaN : (sense * (tx * (x - sx) + ty * (y - sy))) / rise, s];
      }
      let q = this.outermost(path) * (flat ? sense : 1), before = Infinity, s = NaN;
      for (let step = 0; step < STEPS; step++) {
        const c = Math.cos(sense * q), d = Math.sin(sense * q), turn = (x, y) => [c * x - d * y, d * x + c * y];
        const [ax, ay] = straight ? [0, 0] : turn(sx - cx, sy - cy);
        const [x, y] = straight ? [sx + cx * sense * q, sy + cy * sense * q] : [cx + ax, cy + ay];
        const [vx, vy] = straight ? [sense * cx, sense * cy] : [-sense * ay, sense * ax];
        let gap, slope;
        if (flat) {
          const [nx, ny] = turn(tx, ty);
          const [fx, fy] = profile.at((s = profile.touched(nx, ny, true)), 0);
          gap = nx * (x - fx) + ny * (y - fy);
          slope = nx * vx + ny * vy + sense * (nx * (y - fy) - ny * (x - fx));
        } else {
          const [fx, fy, dx, dy] = profile.at((s = profile.touched(x, y, false)), 1), side = this.outward / Math.hypot(dx, dy);
          gap = side * (dy * (x - fx) - dx * (y - fy)) - this.outward * tx;
          slope = side * (dy * vx - dx * vy);
        }
        const far = Math.abs(gap);
        if (!(far > CLOSED * size) || !(far < 0.5 * before || step < APPROACH)) break;
        before = far;
        q -= gap / slope;
      }
      return [q, s];
    }
  }

  Object.assign(page, { Follower });
})();
