"""The equations of textbooks: loop equations as text, Freudenstein's constants, Newton's iterations, dyads.

`compoundkin.loop_equations` gives the loop equations of a mechanism.

>>> import compoundkin as ck
>>> import numpy as np
>>> (constants,) = ck.equations.freudenstein(ck.load("slider-crank"))
>>> constants.text[0]
'K1 s(stroke) cos(crank) + K2 sin(crank) - K3 = s(stroke)^2'
>>> crank = ck.equations.MovingLine((0, 0), np.deg2rad([0, 60, 120]), angular_velocity=2.0)
>>> b = ck.equations.link(crank, 20)
>>> rocker = ck.equations.rrr(b, (70, 0), 65, 40, mode=-1).second
>>> rocker.angular_velocity[0].round(12)     # as 20 / (20 - 70)
np.float64(-0.8)
"""

from __future__ import annotations

from compoundkin.analysis.equations.expressions import latex, text
from compoundkin.analysis.equations.freudenstein import freudenstein
from compoundkin.analysis.equations.newton_iterations import newton_iterations
from compoundkin.kinematics.groups.textbook_dyads import (
    MovingLine,
    MovingPoint,
    line_through,
    link,
    prp,
    rpp,
    rpr,
    rrp,
    rrr,
)

__all__ = [
    "MovingLine",
    "MovingPoint",
    "freudenstein",
    "latex",
    "line_through",
    "link",
    "newton_iterations",
    "prp",
    "rpp",
    "rpr",
    "rrp",
    "rrr",
    "text",
]
