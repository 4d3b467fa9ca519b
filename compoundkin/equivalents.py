"""Linkages that move, up to accelerations, like a mechanism with higher pairs.

>>> import compoundkin as ck
>>> motion = ck.solve(ck.catalog.load_named("disc-cam-offset-roller"))
>>> ck.equivalents.equivalent_linkage(motion, at=0).title
'Equivalent linkage of Disc cam with an offset roller follower'
"""

from __future__ import annotations

from compoundkin.analysis.equivalents import equivalent_linkage

__all__ = ["equivalent_linkage"]
