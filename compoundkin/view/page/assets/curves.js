// Curves through the poses: cubics that have the slopes of the motion, parted where it cannot be assembled and at jumps.
(() => {
  "use strict";
  const page = window.compoundkin;
  const AROUND = 5; // where a slope is not known it is that of the polynomial through so many poses
  const BEYOND = 4; // a jump that is not known is where the polynomial through so many poses leads
  const STEEP = 9; // of slopes beyond, a cubic swings past its ends. Source: F. N. Fritsch and R. E. Carlson (1980).
  const SAME = 1e-6; // of the way from pose to pose: nearer, a place is the pose
  const SEEN = 3e-7; // values are packed with seven digits: a range that is smaller is none
  const STEPS = 6; // lines for a cubic on an axis that is not even
  const SUDDEN = 20, LARGE = 0.02; // a step so many times those beside it, and this part of the range, is a switch: as in drawn plots
  const ALIKE = 0.9, FINE = 16; // vectors that turn more from pose to pose have so many places between for their length

  // --- polynomials through some knots, by Lagrange's formula ---------------------------------------------------------
  const slopeOf = (knots, at) => {
    const { x, y } = knots[at];
    return knots.reduce((sum, one, j) => {
      if (j === at) return sum;
      let weight = 1 / (one.x - x);
      knots.forEach((other, k) => { if (k !== j && k !== at) weight *= (x - other.x) / (one.x - other.x); });
      return sum + weight * (one.y - y);
    }, 0);
  };
  const valueAt = (knots, x) => knots.reduce((sum, one, j) => {
    let weight = one.y;
    knots.forEach((other, k) => { if (k !== j) weight *= (x - other.x) / (one.x - other.x); });
    return sum + weight;
  }, 0);
  const nearest = (knots, at, count) => {
    const first = Math.max(0, Math.min(at - (count >> 1), knots.length - count));
    return [knots.slice(first, first + count), at - first];
  };

  // --- from poses to smooth pieces -----------------------------------------------------------------------------------
  const run = () => ({ knots: [], before: null, after: null });
  // jumps are {place, begins, x, y}: y may be null; values that are not numbers part a curve
  const runsOf = (xs, ys, slopes, jumps, cuts) => {
    const runs = [];
    let own = run();
    const close = () => { if (own.knots.length) runs.push(own); own = run(); };
    let next = 0;
    const pass = (until) => {
      for (; next < jumps.length && jumps[next].place <= until; next++) {
        const jump = jumps[next];
        if (jump.begins) { close(); own.before = jump; } else { own.after = jump; close(); }
      }
    };
    xs.forEach((x, k) => {
      pass(k - SAME);
      if (jumps.some((jump) => Math.abs(jump.place - k) <= SAME)) { pass(k + SAME); return; }
      if (Number.isFinite(ys[k])) own.knots.push({ x, y: ys[k], slope: slopes ? slopes[k] : NaN });
      if (!Number.isFinite(ys[k]) || cuts.has(k)) close();
    });
    pass(Infinity);
    close();
    return runs;
  };
  const pieceOf = ({ knots, before, after }, known) => {
    const ended = (jump, some) => ({ x: jump.x, y: Number.isFinite(jump.y) ? jump.y : valueAt(some, jump.x), slope: NaN });
    const piece = [...knots];
    if (before && knots.length > 1) piece.unshift(ended(before, knots.slice(0, BEYOND)));
    if (after && knots.length > 1) piece.push(ended(after, knots.slice(-BEYOND)));
    for (const { x, y } of known) {
      const at = piece.findIndex((one) => one.x > x);
      // an extreme that was found between two poses is one more place to go through
      if (at > 0 && x - piece[at - 1].x > SAME * (piece[at].x - piece[at - 1].x)) piece.splice(at, 0, { x, y, slope: 0 });
    }
    piece.forEach((one, at) => {
      if (piece.length > 1 && !Number.isFinite(one.slope)) one.slope = slopeOf(...nearest(piece, at, AROUND));
    });
    return piece;
  };
  // the slopes at both ends of a cubic, not so steep that it swings past them
  const held = (a, b) => {
    const chord = (b.y - a.y) / (b.x - a.x), [one, other] = [a.slope / chord, b.slope / chord];
    const size = one * one + other * other;
    const part = one >= 0 && other >= 0 && size > STEEP ? Math.sqrt(STEEP / size) : 1;
    return [a.slope * part, b.slope * part];
  };
  // value and slope of a cubic at a place
  const cubicAt = (a, b, x) => {
    const h = b.x - a.x, t = (x - a.x) / h, [one, other] = held(a, b).map((slope) => slope * h), rise = b.y - a.y;
    const [p, q] = [one + other - 2 * rise, 3 * rise - 2 * one - other];
    return [a.y + t * (one + t * (q + t * p)), (one + t * (2 * q + 3 * t * p)) / h];
  };
  const turns = (a, b) => {
    const h = b.x - a.x, [one, other] = held(a, b).map((slope) => slope * h), rise = b.y - a.y;
    const [p, q, r] = [3 * (one + other - 2 * rise), 2 * (3 * rise - 2 * one - other), one];
    const root = Math.sqrt(q * q - 4 * p * r);
    return (Math.abs(p) < 1e-12 * Math.abs(q) ? [-r / q] : [(-q + root) / (2 * p), (-q - root) / (2 * p)])
      .filter((t) => t > 0 && t < 1)
      .map((t) => ({ x: a.x + t * h, y: a.y + t * (one + t * (q / 2 + (t * p) / 3)) }));
  };

  // One curve: values over places that grow; `slopes` as far as they are known, `jumps`, `extremes` found elsewhere.
  class Curve {
    constructor(xs, ys, { slopes = null, jumps = [], extremes = [], floor = 0, cuts = new Set() } = {}) {
      this.pieces = runsOf(xs, ys, slopes, jumps, cuts).map((one) => pieceOf(one, extremes));
      this.floor = floor;
    }
    // the first lowest and the first highest place of all; none where nothing is known
    get ends() {
      if (this.found) return this.found;
      let low = null, high = null;
      // of places that differ by rounding alone the first
      const slack = this.slack;
      const offer = (one) => {
        if (!low || one.y < low.y - slack) low = one;
        if (!high || one.y > high.y + slack) high = one;
      };
      for (const piece of this.pieces) {
        piece.forEach((one, k) => {
          if (k) turns(piece[k - 1], one).forEach(offer);
          offer(one);
        });
      }
      return (this.found = { low, high });
    }
    // what changes by rounding alone has no extremes
    get marks() {
      const { low, high } = this.ends;
      if (!low) return [];
      return high.y - low.y <= this.slack ? [] : [low, high];
    }
    get slack() {
      return this.pieces.flat().reduce((most, { y }) => Math.max(most, SEEN * Math.abs(y)), this.floor);
    }
    // the curve as a path, places turned into pixels by across and up; `even` where both axes are
    path(across, up, even) {
      const path = new Path2D();
      for (const piece of this.pieces) {
        piece.forEach((b, k) => {
          const a = piece[k - 1];
          if (!k) path.moveTo(across(b.x), up(b.y));
          else if (even) this.cubic(path, a, b, across, up);
          else this.lines(path, a, b, across, up);
        });
      }
      return path;
    }
    cubic(path, a, b, across, up) {
      const third = (b.x - a.x) / 3, [one, other] = held(a, b);
      path.bezierCurveTo(across(a.x + third), up(a.y + one * third), across(b.x - third), up(b.y - other * third), across(b.x), up(b.y));
    }
    lines(path, a, b, across, up) {
      for (let k = 1; k <= STEPS; k++) {
        const x = a.x + ((b.x - a.x) * k) / STEPS;
        path.lineTo(across(x), up(cubicAt(a, b, x)[0]));
      }
    }
    // the value at a place; NaN where there is none
    at(x) {
      for (const piece of this.pieces) {
        const k = piece.findIndex((one) => one.x >= x);
        if (k === 0 && piece[0].x === x) return piece[0].y;
        if (k > 0) return cubicAt(piece[k - 1], piece[k], x)[0];
      }
      return NaN;
    }
  }

  // The length of a vector with curves for both parts: it may turn back at zero between two poses.
  Curve.ofLength = (across, up, extremes, floor) => {
    const curve = new Curve([], [], { floor });
    const knot = (x, [u, du], [v, dv]) => ({ x, y: Math.hypot(u, v), slope: (u * du + v * dv) / Math.hypot(u, v) });
    const own = ({ y, slope }) => [y, slope];
    curve.pieces = across.pieces.map((piece, row) => {
      const other = up.pieces[row];
      const knots = piece.flatMap((b, k) => {
        const a = piece[k - 1], [c, d] = [other[k - 1], other[k]], last = knot(b.x, own(b), own(d));
        if (!k || a.y * b.y + c.y * d.y >= ALIKE * Math.hypot(a.y, c.y) * last.y) return [last];
        const inside = Array.from({ length: FINE - 1 }, (_, j) => a.x + ((j + 1) * (b.x - a.x)) / FINE);
        return [...inside.map((x) => knot(x, cubicAt(a, b, x), cubicAt(c, d, x))), last];
      });
      return pieceOf({ knots }, extremes);
    });
    return curve;
  };
  // after which places a force is switched on or off, as by loads that act one way only, in any of its parts
  Curve.switches = (rows) => {
    const cuts = new Set();
    for (const ys of rows) {
      const known = ys.filter(Number.isFinite), range = Math.max(...known) - Math.min(...known);
      const steps = ys.slice(1).map((y, k) => Math.abs(y - ys[k]));
      steps.forEach((step, k) => {
        const beside = Math.max(steps[k - 1] ?? steps[k + 1], steps[k + 1] ?? steps[k - 1]);
        if (step > SUDDEN * beside && step > LARGE * range) cuts.add(k);
      });
    }
    return cuts;
  };
  page.Curve = Curve;
})();
