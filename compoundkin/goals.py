"""Goals of `optimise`, what shall be least, and its constraints, what shall hold.

>>> import compoundkin as ck
>>> both = ck.goals.path("P", [(1, 2), (3, 4)]) + 0.1 * ck.goals.least("crank.effort.greatest")
>>> [goal.told for _, goal in both.parts]
['P through 2 points with timing', 'crank.effort.greatest as small as can be']
"""

from __future__ import annotations

from compoundkin.studies.goals.least_goal import greatest, least
from compoundkin.studies.goals.path_goal import path

__all__ = [
    "greatest", "least", "path",
]  # fmt: skip
