"""The vector-loop equations of a mechanism: loops, auxiliary equations, drivers, and the count of unknowns.

Sources: R. L. Norton, Design of Machinery, chapter 4; E. Soylemez, Mechanisms, chapter 3 (loop closure equations).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from compoundkin.analysis.equations.rate_equations import RateEquations, rate_equations
from compoundkin.analysis.equations.reduced_system import ReducedSystem, reduced_system
from compoundkin.analysis.equations.vector_loops import DriverEquation, LoopWalk, VectorLoop, pair_terms, shortest_path
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.model.attributes import OF_POINTS
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.loop_terms import Auxiliary, Implicit, LoopTerms, Sum, Unknown, angle_of, difference
from compoundkin.structure import Structure, decompose
from compoundkin.structure.graph import loops_through

# A vector shorter than this part of the size is rounding.
NO_LENGTH = 1e-12
# Nobody would read more loops than this, and they take long to write.
MOST_LOOPS = 200
# Equations of positions, velocities and accelerations.
ORDERS = (0, 1, 2)


@dataclass(frozen=True, eq=False)
class LoopEquations:
    """All equations of a mechanism with their unknowns, and the known lengths by their symbols.

    `system` has the same equations row by row after substitution; `rates` are those of velocities and accelerations up
    to the order of the call.
    """

    structure: Structure
    loops: tuple[VectorLoop, ...]
    auxiliary: tuple[Auxiliary | Implicit, ...]
    drivers: tuple[DriverEquation, ...]
    unknowns: tuple[Unknown, ...]
    lengths: Mapping[str, Number]
    system: ReducedSystem
    rates: tuple[RateEquations, ...] = ()

    @property
    def equations(self) -> int:
        """How many scalar equations there are: two for a loop."""
        return 2 * len(self.loops) + len(self.auxiliary) + len(self.drivers)

    @property
    def is_solvable(self) -> bool:
        """Whether there are as many equations as unknowns."""
        return self.equations == len(self.unknowns)

    @property
    def velocity(self) -> RateEquations:
        """The equations of velocities. Raises InvalidInput for equations of order 0."""
        return self._of_order(1)

    @property
    def acceleration(self) -> RateEquations:
        """The equations of accelerations. Raises InvalidInput for equations below order 2."""
        return self._of_order(2)

    def _of_order(self, order: int) -> RateEquations:
        if order > len(self.rates):
            what = f"the equations were written to order {len(self.rates)}"
            raise InvalidInput(Problem(OF_POINTS[order], what, f"loop_equations(..., order={order})"))
        return self.rates[order - 1]

    def __repr__(self) -> str:
        title, loops = self.structure.mechanism.title, len(self.loops)
        return f"LoopEquations({title!r}: {loops} loops, {self.equations} equations, {len(self.unknowns)} unknowns)"


@checked
def loop_equations(mechanism: Mechanism | Structure, order: int = 0) -> LoopEquations:
    """Return the vector-loop equations of a mechanism, those of rates too above order 0.

    Each link has a vector from pair to pair, at the link's angle; a slide adds its displacement along its guide, and
    ties the angles of block and guide. A loop crosses a pin in a slot, a disc cam and the like by their equivalent
    block or bar, a profile by its parameter. Gears, belts and racks close no loop: they add one equation each.

    Order 1 adds the equations of velocities, order 2 those of accelerations: `velocity` and `acceleration`, with one
    matrix. Driven unknowns and angles that slides tie are substituted there (`system`).

    Raises InvalidInput for more than `MOST_LOOPS` loops and for other orders.

    >>> from compoundkin.files import load
    >>> found = loop_equations(load("slider-crank"))
    >>> len(found.loops), len(found.auxiliary), [unknown.key for unknown in found.unknowns]
    (1, 1, ['crank', 'rod', 'piston', 's(stroke)'])
    >>> found = loop_equations(load("slider-crank"), order=2)
    >>> print(found.velocity.matrix.text)
    [ -AB sin(rod)  -1 ]
    [  AB cos(rod)   0 ]
    """
    if isinstance(order, bool) or order not in ORDERS:
        raise InvalidInput(
            Problem("order", f"{order!r} is no order of equations", "0 position, 1 velocity, 2 acceleration")
        )
    structure = mechanism if isinstance(mechanism, Structure) else decompose(mechanism)
    geometry = structure.mechanism.geometry
    terms = {pair.name: pair_terms(pair, pair.ends(geometry)) for pair in structure.pairs}
    pairs = [pair for pair in structure.pairs if terms[pair.name].is_crossed]
    found = loops_through(structure, pairs)
    if len(found) > MOST_LOOPS:
        what = f"{len(found)} loops are too many to write out"
        raise InvalidInput(Problem("structure", what, f"take a part with {MOST_LOOPS} loops at most"))
    walk = LoopWalk(terms, NO_LENGTH * geometry.size)
    loops = tuple(VectorLoop(loop, tuple(walk.around(loop))) for loop in found)
    crossed = (equation for pair in pairs for equation in terms[pair.name].equations)
    known = {FRAME, *(spin.link for spin in structure.passive)}
    unknowns = [Unknown("angle", name) for name in structure.mechanism.links if name not in known]
    unknowns += [unknown for own in terms.values() for unknown in own.unknowns]
    auxiliary, drivers = (*crossed, *_beside(structure, pairs, walk)), tuple(_drivers(structure, terms))
    system = reduced_system(loops, auxiliary, drivers, unknowns)
    rates = tuple(rate_equations(structure, system, k) for k in range(1, order + 1))
    return LoopEquations(structure, loops, auxiliary, drivers, tuple(unknowns), walk.lengths, system, rates)


def _beside(structure: Structure, pairs: Sequence[Pair], walk: LoopWalk) -> Iterator[Auxiliary | Implicit]:
    """Yield the equations of pairs that no loop crosses; their vectors run through other pairs."""
    others = [pair for pair in structure.pairs if not walk.terms[pair.name].is_crossed]
    found = [(pair, equation) for pair in others for equation in walk.terms[pair.name].equations]
    yield from (own for _, own in found if isinstance(own, Auxiliary) and own.along is None)
    for pair, own in found:
        if isinstance(own, Implicit):
            start, *ends = ((at, f"{pair.name} on {name}") for at, name in zip(own.points, pair.members, strict=True))
            ways = (shortest_path(pairs, pair.members[0], name) for name in pair.members[1:])
            paths = (walk.along(*way, start, end) for way, end in zip(ways, ends, strict=True))
            yield replace(own, ways=tuple(map(tuple, paths)))
        elif own.along is not None:
            start, end = zip(walk.terms[pair.name].points, walk.terms[pair.name].labels, strict=True)
            yield replace(own, path=tuple(walk.along(*shortest_path(pairs, *pair.members[:2]), start, end)))


def _drivers(structure: Structure, terms: Mapping[str, LoopTerms]) -> Iterator[DriverEquation]:
    for step in structure.driven.values():
        free = terms[step.pair.name].unknowns[:1]
        first, second = (angle_of(name) for name in step.pair.members)
        value = Sum(0.0, tuple((1.0, unknown) for unknown in free)) if free else difference(first, second)
        sign = step.pair.driven_by(step.drive.link)
        yield DriverEquation(step.drive.name, value if sign > 0 else value.times(-1.0), step.pair.free_is_angle)
