"""An optimisation as numbers: goals and constraints over free dimensions between bounds, scaled to 0 to 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Generic, TypeAlias, TypeVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.attributes import AXES, component_names
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.goals.goal import DesignConstraint, Goal, GoalUnknown, Term
from compoundkin.studies.responses.designs import Designs, StudiedPath
from compoundkin.studies.responses.response import Response
from compoundkin.studies.samples.variation import Variation

AnyTerm = TypeVar("AnyTerm", bound=Term)


@dataclass(frozen=True, eq=False, repr=False)
class ObjectiveTerm(ShortRepr, Generic[AnyTerm]):
    """A goal or a constraint with its compiled path; `own` are the indices of its unknowns in the space."""

    term: AnyTerm
    path: StudiedPath
    responses: Mapping[str, Response]
    own: range


@dataclass(frozen=True, eq=False, repr=False)
class GoalSpec(ObjectiveTerm[Goal]):
    """A goal with its weight in the sum."""

    weight: float = 1.0


ConstraintSpec: TypeAlias = ObjectiveTerm[DesignConstraint]


@dataclass(frozen=True, eq=False, repr=False)
class DesignProblem(ShortRepr):
    """Goals and constraints over a space; `count` is the number of evaluated designs."""

    space: SearchSpace
    goals: tuple[GoalSpec, ...]
    constraints: tuple[ConstraintSpec, ...]
    count: list[int] = field(default_factory=lambda: [0], repr=False)

    @cached_property
    def is_squares(self) -> bool:
        """Whether the whole objective is a sum of squares."""
        return all(one.term.is_squares for one in self.goals)

    @property
    def terms(self) -> tuple[GoalSpec | ConstraintSpec, ...]:
        """All goals and constraints."""
        return (*self.goals, *self.constraints)

    @property
    def path(self) -> StudiedPath:
        """The path of the first goal."""
        return self.goals[0].path

    @cached_property
    def own_dimensions(self) -> dict[str, Number]:
        """The free dimensions of the original mechanism."""
        programs = self.path.compiled.programs
        return {one.name: programs.stated.own(one) for one in programs.dimensions}

    @property
    def own_parts(self) -> Number:
        """The original design, clipped to the bounds, (1, numbers)."""
        return self.space.parts(self.own_dimensions)[None, :]

    @cached_property
    def has_slopes(self) -> bool:
        """Whether the slopes of all goals and constraints are known."""
        designs = self.at(self.own_parts)
        return all(one.term.has_slopes(designs.trial(one)) for one in self.terms)

    def at(self, parts: Number) -> SearchedDesigns:
        """Return designs by parts of the ranges, (designs, numbers)."""
        found = SearchedDesigns(self, np.atleast_2d(parts))
        self.count[0] += len(found.parts)
        return found

    def guessed(self, parts: Number) -> Number:
        """Return the same designs with the initial unknowns of their goals."""
        if self.space.own == self.space.size:
            return parts
        found, trials = parts.copy(), self.at(parts)
        for one in self.terms:
            if len(one.own):
                low, span = self.space.low[one.own], self.space.span[one.own]
                found[:, one.own] = (one.term.guesses(trials.trial(one)) - low) / span
        return np.clip(np.where(np.isfinite(found), found, parts), *self.space.bounds)


@dataclass(frozen=True, eq=False, repr=False)
class SearchedDesigns(ShortRepr):
    """Some designs of a search, with results computed once; NaN where they are not assembled."""

    problem: DesignProblem
    parts: Number

    @cached_property
    def values(self) -> Number:
        """The objective of each design."""
        total = np.zeros(len(self.parts))
        for one in self.problem.goals:
            found = self._residuals(one)
            total += one.weight * ((found**2).sum(axis=1) if one.term.is_squares else found.sum(axis=1))
        return total

    @cached_property
    def value_slopes(self) -> Number:
        """The slopes of the objective by the parts of the ranges, (designs, numbers)."""
        total = np.zeros(self.parts.shape)
        for one in self.problem.goals:
            slopes = self._spread(one)
            if one.term.is_squares:
                slopes = 2.0 * self._residuals(one)[:, :, None] * slopes
            total += one.weight * slopes.sum(axis=1)
        return total

    @cached_property
    def residuals(self) -> Number:
        """The residuals of all goals, by the roots of their weights."""
        return np.concatenate([np.sqrt(one.weight) * self._residuals(one) for one in self.problem.goals], axis=1)

    @cached_property
    def residual_slopes(self) -> Number:
        """The slopes of those, (designs, residuals, numbers)."""
        return np.concatenate([np.sqrt(one.weight) * self._spread(one) for one in self.problem.goals], axis=1)

    @cached_property
    def margins(self) -> Number:
        """How far all constraints hold, (designs, margins)."""
        found = [one.term.margins(self.trial(one)) for one in self.problem.constraints]
        return np.concatenate(found, axis=1) if found else np.empty((len(self.parts), 0))

    @cached_property
    def margin_slopes(self) -> Number:
        """The slopes of those, (designs, margins, numbers)."""
        found = [self._spread(one) for one in self.problem.constraints]
        return np.concatenate(found, axis=1) if found else np.empty((len(self.parts), 0, self.parts.shape[1]))

    @cached_property
    def assembled(self) -> Number:
        """Which designs have all numbers."""
        return np.isfinite(self.values) & np.isfinite(self.margins).all(axis=1)

    def trial(self, one: GoalSpec | ConstraintSpec) -> DesignTrial:
        """Return the trial designs of a goal or constraint."""
        if one not in self._trials:
            own = self.problem.space.numbers(self.parts)[:, one.own]
            self._trials[one] = DesignTrial(self.designs(one.path), one.responses, own)
        return self._trials[one]

    def designs(self, path: StudiedPath) -> Designs:
        """Return the designs of a path, shared by its terms."""
        if path not in self._designs:
            self._designs[path] = path.designs(self._dimensions)
        return self._designs[path]

    @cached_property
    def _dimensions(self) -> dict[str, Number]:
        return self.problem.space.of_dimensions(self.parts)

    @cached_property
    def _designs(self) -> dict[StudiedPath, Designs]:
        return {}

    @cached_property
    def _trials(self) -> dict[GoalSpec | ConstraintSpec, DesignTrial]:
        return {}

    def _residuals(self, one: GoalSpec) -> Number:
        return one.term.residuals(self.trial(one))

    def _spread(self, one: GoalSpec | ConstraintSpec) -> Number:
        """Return the slopes of a term by all parts of the ranges."""
        space, found = self.problem.space, one.term.slopes(self.trial(one))
        whole = np.zeros((*found.shape[:2], space.size))
        whole[:, :, : space.own], whole[:, :, one.own] = found[:, :, : space.own], found[:, :, space.own :]
        return whole * space.span


@dataclass(frozen=True, eq=False, repr=False)
class SearchSpace(ShortRepr):
    """All numbers that a search changes, scaled to parts of their ranges.

    `names` are the coordinates, two of a point, and then the unknowns; `dimensions` has the indices of the coordinates
    of each free dimension.
    """

    dimensions: Mapping[str, tuple[int, ...]]
    names: tuple[str, ...]
    low: Number
    high: Number
    is_bounded: Number

    @classmethod
    def of(cls, variations: Mapping[str, Variation], unknowns: tuple[GoalUnknown, ...]) -> SearchSpace:
        """Return the space of free dimensions and unknowns. Raises InvalidInput for ranges without ends."""
        ends = {name: _ends(name, one) for name, one in variations.items()}
        places: dict[str, tuple[int, ...]] = {}
        names: list[str] = []
        for name, (least, _) in ends.items():
            parts = component_names(name) if len(least) == len(AXES) else (name,)
            places[name] = tuple(range(len(names), len(names) + len(parts)))
            names += parts
        own = [(one.low, one.high) for one in unknowns]
        low, high = (np.array([*(v for e in ends.values() for v in e[k]), *(o[k] for o in own)]) for k in (0, 1))
        bounded = np.array([True] * len(names) + [one.is_bounded for one in unknowns])
        return cls(places, (*names, *(one.name for one in unknowns)), low, high, bounded)

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return len(self.names)

    @property
    def own(self) -> int:
        """How many of them are dimensions."""
        return sum(map(len, self.dimensions.values()))

    @cached_property
    def span(self) -> Number:
        """The width of the ranges."""
        return self.high - self.low

    @property
    def bounds(self) -> tuple[Number, Number]:
        """The least and the greatest parts, infinite where nothing bounds."""
        return np.where(self.is_bounded, 0.0, -np.inf), np.where(self.is_bounded, 1.0, np.inf)

    def numbers(self, parts: Number) -> Number:
        """Return the numbers at parts of the ranges, (designs, numbers)."""
        return self.low + self.span * parts

    def of_dimensions(self, parts: Number) -> dict[str, Number]:
        """Return the values of the free dimensions, (designs,) each, complex for points."""
        numbers = self.numbers(parts).T
        return {
            name: numbers[at[0]] + 1j * numbers[at[1]] if len(at) == 2 else numbers[at[0]].copy()
            for name, at in self.dimensions.items()
        }

    def parts(self, dimensions: Mapping[str, Number], inside: bool = True) -> Number:
        """Return one design as parts of the ranges, clipped if `inside`; unknowns are in the middle."""
        numbers = self.numbers(np.full(self.size, 0.5))
        for name, at in self.dimensions.items():
            value = dimensions[name]
            numbers[list(at)] = [np.real(value), np.imag(value)] if len(at) == 2 else [np.real(value)]
        found = (numbers - self.low) / self.span
        return np.clip(found, 0.0, 1.0) if inside else found


def _ends(name: str, variation: Variation) -> tuple[list[float], list[float]]:
    """Return the least and greatest coordinates of a dimension."""
    low, high = ([one.real, one.imag][: variation.coordinates] for one in map(complex, variation.ends))
    where, remedy = f"free.{name}", "give a range (40, 60)"
    if not np.isfinite(low + high).all():
        raise InvalidInput(Problem(where, "its values are unbounded", remedy))
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise InvalidInput(Problem(where, "its range has no width", "leave it out where it is not free"))
    beside = np.array([0.5, 0.5 + SIDE])[:, None] * np.ones(variation.coordinates)
    if len(set(variation.values(beside).tolist())) == 1:
        raise InvalidInput(Problem(where, "it has single values, and a search takes all between two", remedy))
    return low, high


# Values so far from each other, as parts of all chances, differ unless a dimension has single values only.
SIDE = 1e-6
