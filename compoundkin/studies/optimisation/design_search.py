"""A search of better designs: many looked at, the best led on all at once, the best ends refined."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.optimisation.design_problem import DesignProblem
from compoundkin.studies.optimisation.evolution import GENERATIONS, evolved
from compoundkin.studies.optimisation.local_methods import EVOLUTION, METHODS, method_of
from compoundkin.studies.optimisation.local_minima import EndedSearch, ended_searches
from compoundkin.studies.optimisation.shared_refinement import refined_together
from compoundkin.studies.optimisation.simultaneous_descent import STEPS, descended
from compoundkin.studies.optimisation.starting_designs import StartingDesigns, starting_designs

# Of the ends of searches led on at once so many different ones are refined, the best.
REFINED = 8
# So many where slopes are differences, which take long.
BY_DIFFERENCES = 2
# Before that, violations of constraints below this part of their size do not matter: refinement ends them.
NEARLY = 1e-2
# Ends that violate constraints by more than this part of their size do not come to hold them.
FAR = 0.2
# Progress is told in so many parts; so many of them are told when the starts are known, and when they were led on.
PARTS, STARTED, LED = 100, 10, 50


@dataclass(frozen=True, eq=False, repr=False)
class DesignSearch(ShortRepr):
    """A search from many starts, the same for a seed. `progress` is told of its parts."""

    problem: DesignProblem
    starts: int
    seed: int
    method: str | None
    progress: Callable[[int, int], None] | None

    @cached_property
    def word(self) -> str:
        """The method, by its word."""
        return method_of(self.problem, self.method, self.problem.has_slopes)

    @cached_property
    def begun(self) -> StartingDesigns:
        """Where its searches begin."""
        return starting_designs(self.problem, self.starts, self.seed, self.problem.own_parts)

    @property
    def leads_on(self) -> bool:
        """Whether all starts are led on at once, before the best ends are refined."""
        return self.word == EVOLUTION or self.problem.has_slopes

    def ends(self) -> list[EndedSearch]:
        """Return where its searches ended, the best first."""
        _ = self.word
        self._tell(0)
        scales = self.begun.scales
        self._tell(STARTED)
        close = ended_searches(self.problem, self._led(), scales, NEARLY)
        self._tell(LED)
        count = self._worth(close)
        refine = METHODS.get(self.word, METHODS["SLSQP"])
        parts = [one.parts for one in close]
        parts[:count] = refined_together(
            self.problem, parts[:count], scales, refine, lambda k: self._tell(LED + (PARTS - LED) * k // count)
        )
        self._tell(PARTS)
        found = ended_searches(self.problem, np.array(parts), scales, searches=[one.searches for one in close])
        refined = {close[k].searches[0] for k in range(count)}
        return [replace(one, is_refined=not refined.isdisjoint(one.searches)) for one in found]

    def _worth(self, close: list[EndedSearch]) -> int:
        """Return how many of the ends are worth refining: none where constraints hold nowhere near."""
        if not self.leads_on:
            return len(close)
        return min(sum(one.violation < FAR for one in close), REFINED if self.problem.has_slopes else BY_DIFFERENCES)

    def _led(self) -> Number:
        """Return where all starts lead at once."""
        if self.word == EVOLUTION:
            found = evolved(self.problem, self.begun.parts, self.begun.scales, self.seed, self._told(GENERATIONS))
            return np.where(self.begun.matters, found, self.begun.parts[0])
        if self.leads_on:
            return descended(self.problem, self.begun.parts, self.begun.scales, self._told(STEPS))
        return self.begun.parts

    def _told(self, steps: int) -> Callable[[], None]:
        """Return what is called after each of some steps that lead all starts on."""
        done = [0]

        def tell() -> None:
            done[0] += 1
            self._tell(STARTED + (LED - STARTED) * min(done[0], steps) // steps)

        return tell

    def _tell(self, done: int) -> None:
        try:
            if self.progress is not None:
                self.progress(done, PARTS)
        except Exception as error:  # whatever a user's function does
            remedy = "give a function of two numbers: how much is done, of how much"
            raise InvalidInput(Problem("progress", f"it cannot be told: {error}", remedy)) from error
