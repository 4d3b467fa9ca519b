// Snapping: round numbers of a grid that fits the scale, the x or y of other points, the lines along links.
(() => {
  "use strict";
  const page = window.compoundkin;
  const FINEST = 5; // pixels between two lines of the grid at least
  const NEAR = 8; // pixels within which other points and lines draw a point to them
  const DIGITS = 1e-7; // of the sketch: finer no coordinate is told

  // 1, 2 or 5 times a power of ten, at least so much
  const roundStep = (least) => {
    const power = 10 ** Math.floor(Math.log10(least) + 1e-9);
    return power * [1, 2, 5, 10].find((by) => by * power >= least * (1 - 1e-9));
  };
  // a multiple of the step, without the dust of floating point
  const toStep = (value, step) => tidy(Math.round(value / step) * step, step);
  const tidy = (value, step) => Number(value.toFixed(Math.min(20, Math.max(0, 3 - Math.floor(Math.log10(step))))));

  // `others` are places of other points, `rays` lines {from, along: unit vector} that the point has been on;
  // gives the place and, for the sketch, what it was drawn to
  const snapped = ([x, y], { step, pixel, others, rays }) => {
    const near = NEAR * pixel;
    let best = { away: near, at: null };
    for (const { from, along } of rays) {
      const dx = x - from[0], dy = y - from[1];
      const away = Math.abs(along[0] * dy - along[1] * dx), length = toStep(along[0] * dx + along[1] * dy, step);
      if (away < best.away && length > 0) best = { away, at: [from[0] + along[0] * length, from[1] + along[1] * length], lines: [from] };
    }
    const nearest = (k, value) => others.reduce((found, one) => (!found || Math.abs(one[k] - value) < Math.abs(found[k] - value) ? one : found), null);
    const onX = nearest(0, x), onY = nearest(1, y);
    const isOn = [onX && Math.abs(onX[0] - x) < best.away, onY && Math.abs(onY[1] - y) < best.away];
    if (best.at && !isOn[0] && !isOn[1]) return best;
    return {
      at: [isOn[0] ? onX[0] : toStep(x, step), isOn[1] ? onY[1] : toStep(y, step)],
      lines: [...(isOn[0] ? [onX] : []), ...(isOn[1] ? [onY] : [])],
    };
  };

  Object.assign(page, { snapped, toStep, tidy, gridStep: (pixel) => roundStep(FINEST * pixel), finest: (size) => roundStep(DIGITS * size) });
})();
