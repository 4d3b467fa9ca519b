"""Cams in motion: pressure angles, radii of curvature, sliding; the mechanism of a made cam.

>>> import compoundkin as ck
>>> ck.cams.cam_pairs(ck.solve(ck.catalog.load_named("disc-cam-offset-roller")))
('roller/cam',)
"""

from __future__ import annotations

from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis, cam_pairs
from compoundkin.model.cam_mechanism import cam_mechanism

__all__ = ["CamAnalysis", "cam_analysis", "cam_mechanism", "cam_pairs"]
