"""Figures of a motion: types of four-bars and slider-cranks.

>>> import compoundkin as ck
>>> ck.performance.linkage_types(ck.catalog.load_named("double-crank"))[0].name
'double-crank (drag link)'
"""

from __future__ import annotations

from compoundkin.analysis.characteristics.four_bar_types import FourBar, four_bar_code
from compoundkin.analysis.characteristics.linkage_types import SliderCrank, linkage_types

__all__ = ["FourBar", "SliderCrank", "four_bar_code", "linkage_types"]
