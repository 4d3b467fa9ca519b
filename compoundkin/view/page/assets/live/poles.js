// Instant centres of a changed mechanism: the pole of two links from their velocities. Homogeneous, as the page's own.
(() => {
  "use strict";
  const page = window.compoundkin;
  const ROUNDING = 1e-9; // parts of the rates below which a difference is rounding

  // (x, y, w) of the pole of links i and j at pose k; w is zero at infinity, all are NaN where neither moves against the other
  page.pole = (links, i, j, k, size) => {
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
})();
