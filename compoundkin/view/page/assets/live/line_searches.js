// Searches along a motion: a least value, a zero; and the polynomial between two poses in time.
(() => {
  "use strict";
  const page = window.compoundkin;
  const GOLDEN = (3 - Math.sqrt(5)) / 2;
  const NEAR = 3e-8; // how near a highest place is searched, of a place: nearer, values differ by rounding alone
  const NEAREST = 1e-11; // of a place: rounding
  const SEARCHES = 60; // steps, at most

  // the least value of a function between two places, by R. P. Brent (1973), chapter 5
  const least = (f, low, high) => {
    let [a, b] = [low, high], x = a + GOLDEN * (b - a), w = x, v = x, fx = f(x), fw = fx, fv = fx, step = 0, before = 0;
    for (let n = 0; n < SEARCHES; n++) {
      const middle = (a + b) / 2, near = NEAR;
      if (Math.abs(x - middle) <= 2 * near - (b - a) / 2) break;
      let golden = true;
      if (Math.abs(before) > near) {
        const r = (x - w) * (fx - fv), q = (x - v) * (fx - fw);
        let p = (x - v) * q - (x - w) * r, d = 2 * (q - r);
        if (d > 0) p = -p;
        d = Math.abs(d);
        if (Math.abs(p) < Math.abs(0.5 * d * before) && p > d * (a - x) && p < d * (b - x)) {
          [before, step] = [step, p / d];
          if (x + step - a < 2 * near || b - x - step < 2 * near) step = x < middle ? near : -near;
          golden = false;
        }
      }
      if (golden) { before = x < middle ? b - x : a - x; step = GOLDEN * before; }
      const u = x + (Math.abs(step) >= near ? step : Math.sign(step) * near), fu = f(u);
      if (fu <= fx) {
        if (u < x) b = x; else a = x;
        [v, fv, w, fw, x, fx] = [w, fw, x, fx, u, fu];
      } else {
        if (u < x) a = u; else b = u;
        if (fu <= fw || w === x) [v, fv, w, fw] = [w, fw, u, fu];
        else if (fu <= fv || v === x || v === w) [v, fv] = [u, fu];
      }
    }
    return x;
  };

  // where a function is zero between two places of different sign, by the Illinois method
  const root = (f, a, b, fa, fb) => {
    for (let n = 0; n < SEARCHES; n++) {
      const c = (a * fb - b * fa) / (fb - fa), fc = f(c);
      if (fc === 0 || Math.abs(c - b) < NEAREST) return c;
      if (fc * fb < 0) [a, fa] = [b, fb];
      else fa /= 2;
      [b, fb] = [c, fc];
    }
    return b;
  };

  // value, rate and second at t of an interval in time, from those at both ends
  const quintic = (h, t, [[a, b], [da, db], [dda, ddb]]) => {
    const [p, q, r] = [da * h, dda * h * h, b - a], [dp, dq] = [db * h, ddb * h * h];
    const c3 = 10 * r - 6 * p - 4 * dp - 1.5 * q + 0.5 * dq, c4 = -15 * r + 8 * p + 7 * dp + 1.5 * q - dq, c5 = 6 * r - 3 * (p + dp) - 0.5 * (q - dq);
    return [
      a + t * (p + t * (q / 2 + t * (c3 + t * (c4 + t * c5)))),
      (p + t * (q + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))) / h,
      (q + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))) / (h * h),
    ];
  };

  Object.assign(page, { least, root, quintic });
})();
