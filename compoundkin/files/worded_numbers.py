"""Numbers that a file writes as text, as people and the command line do: "60 rpm", "0:360:5"."""

from __future__ import annotations

import re
from math import pi
from typing import Any

from compoundkin.base.errors import LikelySlip, warn

# Whichever number Python's float reads, without words such as inf.
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_RATE = re.compile(rf"\s*({_NUMBER})\s*(rpm|1/min|deg|deg/s|rad/s)\s*")
_RANGE = re.compile(rf"\s*({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*({_NUMBER})\s*")
# By its unit the key of the table that says the same.
_KEY = {"rpm": "rpm", "1/min": "rpm", "deg": "deg", "deg/s": "deg"}

# Quarters of a turn in radians, and how far what is rounded to three digits may be from one: 1.57, 3.14, 4.71, 6.28.
_QUARTER, _ROUNDED = pi / 2.0, 6e-4
# A range of so many quarters is looked for; 18 of them are 28.27 degrees, which may well be meant.
_MOST_QUARTERS = 8


def worded_rate(value: Any) -> Any:
    """Read a rate that is written as text, such as "60 rpm".

    It is the number or the table that says the same; what is no such text stays as it is.

    >>> worded_rate("60 rpm"), worded_rate("-1.5 rad/s"), worded_rate("90deg"), worded_rate("fast")
    ({'rpm': 60.0}, -1.5, {'deg': 90.0}, 'fast')
    """
    found = _RATE.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        return value
    return {_KEY[found[2]]: float(found[1])} if found[2] in _KEY else float(found[1])


def worded_range(value: Any) -> Any:
    """Return the table that says the same as "from:to:step"; others as they are.

    >>> worded_range("0:360:5")
    {'from': 0.0, 'to': 360.0, 'step': 5.0}
    """
    found = _RANGE.fullmatch(value) if isinstance(value, str) else None
    return value if found is None else dict(zip(("from", "to", "step"), map(float, found.groups()), strict=True))


def written_end(text: str | None, last: float) -> float:
    """Return the end of ``from:to:step`` as written; the last value may fall short.

    >>> written_end("0:6.283:0.1", 6.2)
    6.283
    """
    parts = (text or "").split(":")
    return float(parts[1]) if len(parts) == 3 else last


def warn_of_radians(where: str, first: float, last: float) -> None:
    """Warn of degrees that are quarters of a turn in radians.

    >>> import pytest
    >>> with pytest.warns(LikelySlip, match="write degrees"):
    ...     warn_of_radians("drives[0].values", 0.0, 6.283)
    """
    quarters = abs(last - first) / _QUARTER
    whole = round(quarters)
    # 11 degrees are seven quarters by chance: nobody rounds radians to whole numbers
    is_rounded = float(last - first).is_integer()
    if not is_rounded and 1 <= whole <= _MOST_QUARTERS and abs(quarters - whole) <= _ROUNDED * whole:
        told = f"{where}: {first:g} to {last:g} degrees look like radians"
        warn(f"{told}; write degrees, or {{ rad = [...] }}", LikelySlip)
