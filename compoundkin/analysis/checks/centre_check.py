"""The solved velocities against the instant centres, which geometry alone gives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.centres import instant_centres
from compoundkin.analysis.checks.finding import Finding, worst
from compoundkin.base.errors import NotDetermined
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion

TOLERANCE = 1e-9
# n links have n (n - 1) / 2 centres and n (n - 1) (n - 2) / 6 triples: beyond this many links they take longer
# than the motion did, and a mechanism of so many links is no longer checked by them.
MOST_LINKS = 40


def centre_findings(motion: Motion) -> Iterator[Finding]:
    """Velocities from centres, and the theorem itself, at poses where they are well conditioned.

    Nothing for a motion without velocities, without drivers, or of more than MOST_LINKS links.
    """
    still = motion.order < 1 or not motion.inputs.drives or not motion.regular.any()
    if still or len(motion.mechanism.links) > MOST_LINKS:
        return
    try:
        centres = instant_centres(motion)
    except NotDetermined:
        return
    check = centres.velocity_check()
    yield _finding(motion, "velocities from centres", {**check.links, **check.points})
    triples = {" ".join(names): value for names, value in centres.collinearity().items()}
    yield _finding(motion, "Kennedy collinearity", triples)


def _finding(motion: Motion, name: str, parts: dict[str, Number]) -> Finding:
    # NaN is where a centre is not determined or too poorly conditioned to prove anything
    shape = motion.shape or (1,)
    flat = {k: np.nan_to_num(np.broadcast_to(v, shape).reshape(motion.failed.shape), nan=0.0) for k, v in parts.items()}
    return worst(motion, name, TOLERANCE, flat, motion.regular)
