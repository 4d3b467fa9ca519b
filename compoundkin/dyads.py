"""The textbook routines: dyads and points of links as plain functions of moving points and lines.

>>> import compoundkin as ck
>>> import numpy as np
>>> crank = ck.dyads.MovingLine((0, 0), np.deg2rad([0, 60, 120]), angular_velocity=2.0)
>>> b = ck.dyads.link(crank, 20)
>>> rocker = ck.dyads.rrr(b, (70, 0), 65, 40, mode=-1).second
>>> rocker.angular_velocity[0].round(12)     # as 20 / (20 - 70)
np.float64(-0.8)
"""

from __future__ import annotations

from compoundkin.kinematics.groups.given_dyads import SolvedDyad
from compoundkin.kinematics.groups.textbook_dyads import line_through, link, prp, rpp, rpr, rrp, rrr
from compoundkin.kinematics.moving_lines import MovingLine, MovingPoint, Travel

__all__ = [
    "MovingLine", "MovingPoint", "SolvedDyad", "Travel", "line_through", "link", "prp", "rpp", "rpr", "rrp", "rrr",
]  # fmt: skip
