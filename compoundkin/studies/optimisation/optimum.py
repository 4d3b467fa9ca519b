"""The result of an optimisation: the mechanism, its changed dimensions, active constraints, and other local minima.

Assembly modes are written into the mechanism, so that it moves as it did in the search.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from compoundkin.analysis.checks import Check, verify
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase, display_function
from compoundkin.base.errors import CompoundkinError, suppress_pose_warnings
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.curve.modes import read_name
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.model.elements import mode
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.compiled_path import CompiledPath
from compoundkin.studies.goals.goal import Goal


@dataclass(frozen=True)
class ChangedDimension:
    """A free number before and after, and its bounds.

    `binds` is "low" or "high" at an active bound. A dimension that does not matter influences no goal or constraint,
    and is unchanged.
    """

    name: str
    unit: str
    before: float
    after: float
    low: float
    high: float
    binds: str = ""
    matters: bool = True


@dataclass(frozen=True)
class HeldConstraint:
    """A constraint at the optimum, with its least `margin` in its unit."""

    description: str
    margin: float
    unit: str
    is_held: bool
    binds: bool


@dataclass(frozen=True, eq=False, repr=False)
class LocalMinimum(ShortRepr):
    """A design at which searches ended: its objective, its dimensions, and which searches."""

    value: float
    dimensions: Mapping[str, Any]
    searches: tuple[int, ...]
    is_held: bool
    _path: CompiledPath
    _moved: Mapping[str, Any]

    @cached_property
    def motion(self) -> Motion:
        """Its motion, in the configuration of the search."""
        with suppress_pose_warnings():
            return solve(self._designed, **self._solve_arguments)

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism with its dimensions, which moves as in the search."""
        with suppress_pose_warnings():
            return with_modes(self._designed, self.motion, self._solve_arguments)

    @property
    def modes(self) -> str | Configuration:
        """The configuration of the search."""
        return self._path.modes

    @property
    def _solve_arguments(self) -> dict[str, Any]:
        return {**self._moved, "modes": self._path.modes}

    @property
    def _designed(self) -> Mechanism:
        return self._path.mechanism(self.dimensions)

    def __repr__(self) -> str:
        return (
            f"LocalMinimum({self.value:.6g}, at which {count_phrase(len(self.searches), 'search', 'searches')} ended)"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(DisplaysHtml, ShortRepr):
    """The best design of a search.

    `value` is its objective, `value_before` that of the mechanism as it stood (NaN where it is not assembled), `goals`
    say what it is; `changes` tell what became of the free numbers, `constraints` how they hold, `unknowns` what goals
    found beside the dimensions. Of `screened` designs `assembled` were; searches began at the best of them: `begun` are
    the objectives there, `ended` those where they ended. `minima` are all those designs, the best first. `evaluations`
    designs were looked at in all, in so many `seconds`, by a `method` of SciPy. `is_whole` tells whether the best
    design is assembled over the whole motion, between its poses too.
    """

    value: float
    value_before: float
    changes: tuple[ChangedDimension, ...]
    constraints: tuple[HeldConstraint, ...]
    unknowns: Mapping[str, float]
    goals: tuple[Goal, ...]
    minima: tuple[LocalMinimum, ...]
    begun: Number
    ended: Number
    screened: int
    assembled: int
    evaluations: int
    seconds: float
    method: str
    before: Motion
    is_whole: bool

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism with the best dimensions."""
        return self.minima[0].mechanism

    @property
    def motion(self) -> Motion:
        """Its motion; `before` is that of the mechanism as it stood."""
        return self.minima[0].motion

    @cached_property
    def check(self) -> Check:
        """The verification of its motion."""
        with suppress_pose_warnings():
            return verify(self.motion)

    @property
    def dimensions(self) -> Mapping[str, Any]:
        """The best free dimensions by name, points complex."""
        return self.minima[0].dimensions

    @property
    def starts(self) -> int:
        """How many searches there were."""
        return len(self.begun)

    @property
    def agreed(self) -> int:
        """How many searches ended at an objective as good, here or elsewhere."""
        return int(np.count_nonzero(self.ended - self.value <= AGREED * abs(self.value) + NOTHING * self._size))

    @property
    def binding(self) -> tuple[str, ...]:
        """Active bounds and constraints, as text."""
        bounds = [f"{one.name} at its {one.binds} bound" for one in self.changes if one.binds]
        return (*bounds, *(one.description for one in self.constraints if one.binds))

    @property
    def is_held(self) -> bool:
        """Whether all constraints hold."""
        return all(one.is_held for one in self.constraints)

    def plot(self, *names: str, **options: Any) -> Any:
        """Plot the improvement; see `plots.improvement`."""
        return display_function("study_plot")(self, *names, **options)

    @property
    def _size(self) -> float:
        return float(np.median(np.abs(self.begun)))

    def __repr__(self) -> str:
        bound = f", bound by {', '.join(self.binding)}" if self.binding else ""
        searches = f"{self.agreed} of {count_phrase(self.starts, 'search', 'searches')} agree"
        return f"Optimum({self.value_before:.6g} -> {self.value:.6g}, {searches}{bound})"


# Searches agree where their objectives differ by less than this part, or by this part of the initial objectives.
AGREED, NOTHING = 1e-4, 1e-12


def with_modes(mechanism: Mechanism, motion: Motion, moved: Mapping[str, Any]) -> Mechanism:
    """Return the mechanism, with its assembly modes if it would otherwise move differently.

    `moved` are the arguments of `solve`. Numbered configurations cannot be written: such a mechanism is returned
    unchanged.
    """
    modes, alone = moved["modes"], {**moved, "modes": None}
    if not isinstance(modes, str) or _moves_so(mechanism, motion, alone):
        return mechanism
    written = mechanism.replace(*_modes(mechanism, motion, modes))
    return written if _moves_so(written, motion, alone) else mechanism


def _modes(mechanism: Mechanism, motion: Motion, modes: str) -> list[Any]:
    # by the name: at a change point the motion itself has neither sign
    found = []
    for index, sign in read_name(motion.solving_order, modes).items():
        links = motion.structure.groups[index].links
        own = next((one for one in mechanism.modes if set(one.links) & set(links)), None)
        found.append(mode(sign, *(own.links if own else links[:1])))
    return found


def _moves_so(mechanism: Mechanism, motion: Motion, moved: Mapping[str, Any]) -> bool:
    """Return whether a mechanism has this motion by itself."""
    try:
        own = solve(mechanism, **moved)
    except CompoundkinError:
        return False
    there, wanted = (np.array([point.position for point in found.points.values()]) for found in (own, motion))
    size = np.nanmax(np.abs(wanted), initial=1.0)
    return bool(np.allclose(there, wanted, rtol=0.0, atol=SAME_POSE * size, equal_nan=True))


# Numbered configurations are found by Newton's steps to some ten digits.
SAME_POSE = 1e-8
