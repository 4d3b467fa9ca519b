"""What is asked of cams in motion: pressure angles, radii of curvature, sliding.

>>> import compoundkin as ck
>>> ck.cams.cam_pairs(ck.solve(ck.catalog.load_named("disc-cam-offset-roller")))
('roller/cam',)
"""

from __future__ import annotations

from compoundkin.analysis.cam_analysis import CamAnalysis, cam_analysis, cam_pairs

__all__ = ["CamAnalysis", "cam_analysis", "cam_pairs"]
