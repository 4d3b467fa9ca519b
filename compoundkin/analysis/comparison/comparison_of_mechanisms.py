"""`compare`: two mechanisms side by side, their structure, their dimensions, and how far apart they move."""

from __future__ import annotations

from dataclasses import replace

from compoundkin.analysis.comparison.common_pose import common_pose
from compoundkin.analysis.comparison.compared_facts import compared_facts
from compoundkin.analysis.comparison.compared_side import compared_side
from compoundkin.analysis.comparison.comparison_findings import MechanismComparison
from compoundkin.analysis.comparison.driver_partners import driver_partners
from compoundkin.analysis.comparison.link_partners import compared_lengths, link_partners
from compoundkin.analysis.comparison.shared_course import SharedCourse
from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, NotAssembled, NotDetermined
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose


@checked
def compare(one: Mechanism, other: Mechanism) -> MechanismComparison:
    """Compare two mechanisms: structure, dimensions, and how far apart they come when moved alike.

    They are moved from a pose that both have, by the same displacements of their drivers, over the range that both
    have. Points stand for each other that are in the same places there and go on together, else those of the same name;
    drivers do that move these points alike. Lengths of the second are converted by the units. Where one has none, or
    nothing fits so, they are taken as written, or times a power of ten. The frames' axes are the same.

    Nothing is raised for mechanisms that cannot be solved or have nothing in common: the comparison then says why.

    >>> from compoundkin.model.elements import drive, drawn, link
    >>> crank = Mechanism("Crank", link("frame", A=0), link("crank", A=0, B=2), drive("crank"))
    >>> other = Mechanism("Other", link("frame", "O"), link("arm", "O", "Q"), drive("arm"), drawn(O=0, Q=2j))
    >>> found = compare(crank, other)
    >>> found.points, found.largest.distance < 1e-12
    ({'A': 'O', 'B': 'Q'}, True)
    """
    structures = decompose(one), decompose(other)
    facts = compared_facts(*structures)
    known = MechanismComparison(structures, 1.0, 0.0, "", {}, {}, facts)
    try:
        return _moved(known)
    except (InvalidInput, NotAssembled, NotDetermined) as error:
        return replace(known, why=error.problems[0].what if error.problems else str(error))


def _moved(known: MechanismComparison) -> MechanismComparison:
    """Return a comparison with what the motions tell. Raises what keeps them from being solved."""
    common = common_pose(*map(compared_side, known.structures))
    if common is None:
        return replace(known, why="they have no pose in common, and few points of the same names")
    known = replace(known, scale=common.other.scale, size=common.one.size, matched_by=common.matched_by)
    known = _dimensioned(known, dict(common.points))
    course = SharedCourse(common, driver_partners(common))
    counts = len(common.one.motion.drives), len(common.other.motion.drives)
    if len(course.drivers) < max(counts):
        return replace(known, drivers=tuple(course.drivers), why="their drivers do not stand for each other")
    known = _dimensioned(known, course.points)
    if not course.both.size:
        return replace(known, drivers=tuple(course.drivers), why="no pose can be assembled in both")
    places = sorted(course.places(), key=lambda one: -one.distance)
    return replace(
        known,
        drivers=tuple(course.drivers),
        places=tuple(places),
        turns=tuple(course.turns(_untold(known))),
        motions=course.motions,
        poses=int(course.both.size),
        apart=course.apart,
    )


def _dimensioned(known: MechanismComparison, points: dict[str, str]) -> MechanismComparison:
    """Return a comparison with the points that stand for each other, the links that follow and their lengths."""
    mechanisms = known.structures[0].mechanism, known.structures[1].mechanism
    links = link_partners(*mechanisms, points)
    lengths = tuple(compared_lengths(*mechanisms, links, points, known.scale))
    return replace(known, points=points, links=links, lengths=lengths)


def _untold(known: MechanismComparison) -> dict[str, str]:
    """Return the moving links that have no two points, so that places do not tell how they turn."""
    told = {length.link for length in known.lengths if min(length.one, length.other) > 0.0}
    return {name: partner for name, partner in known.links.items() if name not in told and name != FRAME}
