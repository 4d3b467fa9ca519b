"""The states of designs: whether they assemble over the whole motion, on which branch and circuit, and why not."""

from __future__ import annotations

import numpy as np

from compoundkin.base.series import Number
from compoundkin.studies.responses.designs import Designs

STATES = ("assembled", "branch", "circuit", "order_defect", "reason")
ASSEMBLED, BRANCH, CIRCUIT, ORDER_DEFECT, REASON = STATES


def design_states(designs: Designs) -> dict[str, Number]:
    """Return the states of designs by name.

    They are (designs,) each; texts are objects, None where there is none.
    """
    assembled = np.broadcast_to(designs.found.assembled, (designs.number, designs.poses)).all(axis=-1)
    name = str(designs.path.compiled.modes)
    texts = {word: np.full(designs.number, text, dtype=object) for word, text in ((BRANCH, name), (CIRCUIT, name))}
    missing = np.full(designs.number, None, dtype=object)
    missing[~assembled] = "some poses cannot be assembled"
    return {ASSEMBLED: assembled, **texts, ORDER_DEFECT: np.zeros(designs.number, dtype=bool), REASON: missing}
