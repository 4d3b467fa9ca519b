"""Goals of `optimise`, what shall be least, and its constraints, what shall hold.

>>> import compoundkin as ck
>>> both = ck.goals.path("P", [(1, 2), (3, 4)]) + 0.1 * ck.goals.least("crank.effort.greatest")
>>> [goal.description for _, goal in both.parts]
['P through 2 points with timing', 'crank.effort.greatest as small as can be']
"""

from __future__ import annotations

from compoundkin.studies.goals.clearance_constraint import clearance
from compoundkin.studies.goals.constraints import assembles, at_least, at_most, box, distance, full_turn, transmits
from compoundkin.studies.goals.path_goals import function, path, poses, trace
from compoundkin.studies.goals.range_goals import dwell, even, straight_line, without_harmonics
from compoundkin.studies.goals.value_goals import greatest, least, target

__all__ = [
    "assembles",
    "at_least",
    "at_most",
    "box",
    "clearance",
    "distance",
    "dwell",
    "even",
    "full_turn",
    "function",
    "greatest",
    "least",
    "path",
    "poses",
    "straight_line",
    "target",
    "trace",
    "transmits",
    "without_harmonics",
]
