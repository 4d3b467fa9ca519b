"""Figures of a motion: types of four-bars and slider-cranks, features of coupler curves.

>>> import compoundkin as ck
>>> ck.performance.linkage_types(ck.catalog.load_named("double-crank"))[0].name
'double-crank (drag link)'
"""

from __future__ import annotations

from compoundkin.analysis.characteristics.curve_features import PathFeatures, path_features
from compoundkin.analysis.characteristics.four_bar_types import FourBar, four_bar_code
from compoundkin.analysis.characteristics.linkage_types import SliderCrank, linkage_types
from compoundkin.analysis.characteristics.path_stretches import Stretch, straightness

__all__ = [
    "FourBar",
    "PathFeatures",
    "SliderCrank",
    "Stretch",
    "four_bar_code",
    "linkage_types",
    "path_features",
    "straightness",
]
