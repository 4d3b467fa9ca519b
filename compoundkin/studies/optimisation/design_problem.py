"""A problem of better dimensions as numbers: what is asked of designs, by parts of the ranges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Generic, TypeAlias, TypeVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.goals.contract import DesignConstraint, Goal, Term
from compoundkin.studies.goals.design_trial import DesignTrial
from compoundkin.studies.optimisation.search_space import SearchSpace
from compoundkin.studies.responses.contract import Response
from compoundkin.studies.responses.designs import Designs, StudiedPath

AnyTerm = TypeVar("AnyTerm", bound=Term)


@dataclass(frozen=True, eq=False, repr=False)
class AskedTerm(ShortRepr, Generic[AnyTerm]):
    """A goal or a constraint with the path that it asks.

    `own` are the numbers of the space that are its unknowns.
    """

    term: AnyTerm
    path: StudiedPath
    responses: Mapping[str, Response]
    own: range


@dataclass(frozen=True, eq=False, repr=False)
class AskedGoal(AskedTerm[Goal]):
    """A goal with its weight in the sum."""

    weight: float = 1.0


AskedConstraint: TypeAlias = AskedTerm[DesignConstraint]


@dataclass(frozen=True, eq=False, repr=False)
class DesignProblem(ShortRepr):
    """Goals and constraints over a space. `count` is of the designs that were looked at."""

    space: SearchSpace
    goals: tuple[AskedGoal, ...]
    constraints: tuple[AskedConstraint, ...]
    count: list[int] = field(default_factory=lambda: [0], repr=False)

    @cached_property
    def is_squares(self) -> bool:
        """Whether the whole objective is a sum of squares."""
        return all(one.term.is_squares for one in self.goals)

    @property
    def terms(self) -> tuple[AskedGoal | AskedConstraint, ...]:
        """All goals and constraints."""
        return (*self.goals, *self.constraints)

    @property
    def path(self) -> StudiedPath:
        """The path of the first goal."""
        return self.goals[0].path

    @cached_property
    def own_dimensions(self) -> dict[str, Number]:
        """The free dimensions as they stand."""
        programs = self.path.compiled.programs
        return {one.name: programs.stated.own(one) for one in programs.dimensions}

    @property
    def own_parts(self) -> Number:
        """The design as it stands, within the bounds, (1, numbers)."""
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
        """Return the same designs, with the unknowns that goals say are good."""
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
    """Some designs of a search; what is computed of them is computed once. NaN where they are not assembled."""

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

    def trial(self, one: AskedGoal | AskedConstraint) -> DesignTrial:
        """Return the designs as a goal or constraint sees them."""
        if one not in self._trials:
            own = self.problem.space.numbers(self.parts)[:, one.own]
            self._trials[one] = DesignTrial(self.designs(one.path), one.responses, own)
        return self._trials[one]

    def designs(self, path: StudiedPath) -> Designs:
        """Return the designs of a path, the same for all that ask it."""
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
    def _trials(self) -> dict[AskedGoal | AskedConstraint, DesignTrial]:
        return {}

    def _residuals(self, one: AskedGoal) -> Number:
        return one.term.residuals(self.trial(one))

    def _spread(self, one: AskedGoal | AskedConstraint) -> Number:
        """Return the slopes of a term by all parts of the ranges."""
        space, found = self.problem.space, one.term.slopes(self.trial(one))
        whole = np.zeros((*found.shape[:2], space.size))
        whole[:, :, : space.own], whole[:, :, one.own] = found[:, :, : space.own], found[:, :, space.own :]
        return whole * space.span
