"""Plane curves in a link's own frame: the profiles of cams and the centre lines of curved slots.

Every kind gives only its Taylor expansion at a parameter (`Curve.expansion`); points, normals, curvature, the foot
of a point, the point a flat face touches and parallel curves follow from that.
"""

from compoundkin.base.curves.curve import Analytic, Curve
from compoundkin.base.curves.samples import Crossing
from compoundkin.base.curves.spline import Function, Spline

__all__ = ["Analytic", "Crossing", "Curve", "Function", "Spline"]
