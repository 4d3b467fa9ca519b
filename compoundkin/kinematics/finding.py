"""What a check finds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml
from compoundkin.kinematics.motion import Motion

# So many times the estimate of its error a residual may be: it adds the errors of several links.
LEFT = 10.0
# A pose slower than this part of the motion's fastest is judged by that: a mechanism at rest has no own scale.
SLOWEST = 1e-6


@dataclass(frozen=True)
class Finding:
    """One check with its worst value, its limit, and where it is worst.

    The value is relative to the mechanism's size and speed.
    `pose` is the index into the motion's shape; a value that is not a number does not pass.
    """

    name: str
    value: float
    limit: float
    pair: str
    pose: tuple[int, ...]

    @property
    def passed(self) -> bool:
        """Whether the value is within its limit."""
        return self.value <= self.limit


@dataclass(frozen=True, repr=False)
class Check(DisplaysHtml):
    """All findings about a motion. `poses` of them were checked, `singular` had no rates to check."""

    findings: tuple[Finding, ...]
    poses: int
    singular: int

    @property
    def passed(self) -> bool:
        """Whether every finding passed, and there was something to check."""
        return self.poses > 0 and not self.failed

    @property
    def failed(self) -> tuple[str, ...]:
        """The names of the findings that did not pass."""
        return tuple(finding.name for finding in self.findings if not finding.passed)

    @property
    def verdict(self) -> str:
        """What all findings come to in words, as headlines and badges say it."""
        if not self.poses:
            return "nothing could be checked"
        if self.failed:
            return f"{len(self.failed)} of {len(self.findings)} checks FAILED"
        return f"all {len(self.findings)} checks passed"

    def __repr__(self) -> str:
        outcome = "passed" if self.passed else f"failed: {', '.join(self.failed) or 'nothing to check'}"
        return f"Check({len(self.findings)} findings at {self.poses} poses, {outcome})"


class Checkable(Protocol):
    """What has findings of its own, such as the forces of a motion."""

    def check(self) -> Check:
        """Return its findings."""


def rounded_by(
    motion: Motion, k: int, parts: Mapping[str, Number], limit: float, scale: Number | None = None
) -> dict[str, Number]:
    """Return values by the share of their limit that rounding leaves at each pose.

    Next to a limit position what rounding leaves in the k-th derivative, relative to a `scale` (the size), is more than
    the limit: it is the limit there, and values are made less accordingly.
    """
    with np.errstate(all="ignore"):
        error = motion.error(k).reshape(motion.failed.shape) / (motion.sizes if scale is None else scale)
    allowed = np.nan_to_num(LEFT * error, nan=0.0, posinf=np.inf)
    share = limit / np.maximum(limit, allowed)
    return {name: part * share for name, part in parts.items()}


def worst(motion: Motion, name: str, limit: float, parts: dict[str, Number], counted: Number) -> Finding:
    """Return the worst value over all parts at the poses that count.

    Each part is designs x poses, or is broadcast to it.
    A value that is not a number is worse than any other.
    """
    found, all_count = Finding(name, 0.0, limit, "", ()), bool(counted.all())
    for label, part in parts.items():
        values = part if all_count and np.shape(part) == counted.shape else np.where(counted, part, 0.0)
        at = int(values.argmax())
        value = float(values.flat[at])
        if value != value:
            at = int(np.argmax(np.where(np.isnan(values), np.inf, values)))
            value = float(values.flat[at])
        if not value <= found.value:
            pose = tuple(int(i) for i in np.unravel_index(at, motion.shape)) if motion.shape else ()
            found = Finding(name, value, limit, label, pose)
    return found
