"""Figures of a mechanism: types of linkages, features of coupler curves, workspaces.

>>> import compoundkin as ck
>>> ck.performance.linkage_types(ck.catalog.load_named("double-crank"))[0].name
'double-crank (drag link)'
"""

from __future__ import annotations

from compoundkin.analysis.characteristics.dwells import Dwell
from compoundkin.analysis.characteristics.figures import PlacedFigure, Range
from compoundkin.analysis.characteristics.linkage_types import FourBar, SliderCrank, four_bar_code, linkage_types
from compoundkin.analysis.characteristics.output_figures import OutputFigures, QuickReturn
from compoundkin.analysis.characteristics.path_features import PathFeatures, Stretch, path_features, straightness
from compoundkin.analysis.characteristics.transmission import AdvantageFigures, GroupFigures
from compoundkin.configurations.workspace import workspace

__all__ = [
    "AdvantageFigures",
    "Dwell",
    "FourBar",
    "GroupFigures",
    "OutputFigures",
    "PathFeatures",
    "PlacedFigure",
    "QuickReturn",
    "Range",
    "SliderCrank",
    "Stretch",
    "four_bar_code",
    "linkage_types",
    "path_features",
    "straightness",
    "workspace",
]
