"""Figures of a mechanism: types of linkages, features of coupler curves, workspaces.

>>> import compoundkin as ck
>>> ck.performance.linkage_types(ck.catalog.load_named("double-crank"))[0].name
'double-crank (drag link)'
"""

from __future__ import annotations

from compoundkin.analysis.characteristics.advantage_figures import AdvantageFigures
from compoundkin.analysis.characteristics.curve_features import PathFeatures, path_features
from compoundkin.analysis.characteristics.figure import PlacedFigure, Range
from compoundkin.analysis.characteristics.four_bar_types import FourBar, four_bar_code
from compoundkin.analysis.characteristics.group_figures import GroupFigures
from compoundkin.analysis.characteristics.linkage_types import SliderCrank, linkage_types
from compoundkin.analysis.characteristics.output_dwells import Dwell
from compoundkin.analysis.characteristics.output_figures import OutputFigures
from compoundkin.analysis.characteristics.output_strokes import QuickReturn
from compoundkin.analysis.characteristics.path_stretches import Stretch, straightness
from compoundkin.configurations.reached_region import workspace

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
