"""Bins of histograms: few for few values, never very many."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.plot import canvas

# Bins in a histogram of very many values, and of those with far outliers.
MOST = 60


def bins(values: Number, scale: float, most: int = MOST) -> Number:
    """Return the edges of bins by the rule of Freedman and Diaconis.

    Around constants there are three, of which the middle one holds all.

    Source: D. Freedman, P. Diaconis, On the histogram as a density estimator (1981).

    >>> bins(np.array([2.0, 2.0]), 2.0).tolist()
    [1.0, 1.6666666666666665, 2.333333333333333, 3.0]
    >>> len(bins(np.arange(10**6.0), 1e6)), len(bins(np.array([np.nan]), 0.0))
    (61, 2)
    """
    known = values[np.isfinite(values)]
    still = canvas.steady(known, scale)
    if not len(known):
        return np.array([0.0, 1.0])
    if still is not None:
        return np.linspace(*still, 4)
    quarters = np.subtract(*np.percentile(known, [75.0, 25.0]))
    width = 2.0 * quarters / len(known) ** (1.0 / 3.0)
    wished = np.ptp(known) / width if width > 0.0 else most
    return np.linspace(known.min(), known.max(), int(np.clip(np.ceil(wished), 1, most)) + 1)
