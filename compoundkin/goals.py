"""Goals of `optimise`, what shall be least, and its constraints, what shall hold.

>>> import compoundkin as ck
>>> both = ck.goals.path("P", [(1, 2), (3, 4)]) + 0.1 * ck.goals.least("crank.effort.greatest")
>>> [goal.told for _, goal in both.parts]
['P through 2 points with timing', 'crank.effort.greatest as small as can be']
"""

from __future__ import annotations

from compoundkin.studies.goals.assembly_constraint import assembles, full_turn
from compoundkin.studies.goals.bound_constraint import at_least, at_most, box, transmits
from compoundkin.studies.goals.clearance_constraint import clearance
from compoundkin.studies.goals.distance_constraint import distance
from compoundkin.studies.goals.dwell_goal import dwell, even
from compoundkin.studies.goals.function_goal import function
from compoundkin.studies.goals.least_goal import greatest, least
from compoundkin.studies.goals.path_goal import path
from compoundkin.studies.goals.pose_goal import poses
from compoundkin.studies.goals.straight_line_goal import straight_line
from compoundkin.studies.goals.target_goal import target
from compoundkin.studies.goals.trace_goal import trace

__all__ = [
    "assembles", "at_least", "at_most", "box", "clearance", "distance", "dwell", "even", "full_turn", "function",
    "greatest", "least", "path", "poses", "straight_line", "target", "trace", "transmits",
]  # fmt: skip
