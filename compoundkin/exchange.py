"""Files of other programs, read and written: PMKS, PMKS+, Linkage, pyslvs, pylinkage and more; the shipped mechanisms.

>>> import compoundkin as ck
>>> ck.exchange.read("ground,crank,R,0,0\\ncrank,rod,R,1,2\\nrod,slide,R,5,0\\nslide,ground,P,5,0,0").form
'pmks'
>>> "six-bar" in ck.exchange.shipped()
True
"""

from __future__ import annotations

from compoundkin.analysis.comparison import compare
from compoundkin.files.exchange.known_formats import formats, read, write
from compoundkin.files.exchange.pylinkage_format import from_pylinkage
from compoundkin.files.shipped_mechanisms import shipped

__all__ = [
    "compare",
    "formats",
    "from_pylinkage",
    "read",
    "shipped",
    "write",
]
