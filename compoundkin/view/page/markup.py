"""Pieces of HTML: text made safe, elements, data and packed numbers for scripts."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Iterable
from html import escape
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number

# Characters that a page may not hold, not even escaped. Source: HTML Living Standard, 13.2.3.5.
_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]")
# Where a long name such as "bar.angular_acceleration" may be broken.
_BREAK = re.compile(r"([._])(?=\w)")


def packed_doubles(values: Number) -> str | float | None:
    """Return numbers as doubles, those of a script. One number where they are all the same, None where none is known.

    >>> packed_doubles(np.array([1.0, 2.0]))
    'd:AAAAAAAA8D8AAAAAAAAAQA=='
    >>> packed_doubles(np.array([3.0, 3.0])), packed_doubles(np.array([np.nan]))
    (3.0, None)
    """
    return _packed(values, "<f8", "d:")


def packed_floats(values: Number) -> str | float | None:
    """Pack as `packed_doubles`, with seven digits: half as long.

    >>> packed_floats(np.array([1.0, 2.0]))
    'f:AACAPwAAAEA='
    """
    return _packed(values, "<f4", "f:")


def component_values(values: Number, floor: float) -> dict[str, Number]:
    """Return the components of a quantity, rounding set to zero as in the report's tables.

    >>> component_values(np.array([2.0 + 1e-15j]), 1e-12)
    {'x': array([2.]), 'y': array([0.])}
    """
    parts = {"x": values.real, "y": values.imag} if np.iscomplexobj(values) else {"": values}
    return {name: np.where(np.abs(part) <= floor, 0.0, part) for name, part in parts.items()}


def _packed(values: Number, form: str, mark: str) -> str | float | None:
    given = np.asarray(values, dtype=float)
    if not np.isfinite(given).any():
        return None
    # adding zero makes the negative zero an ordinary one
    first = float(given.flat[0]) + 0.0
    if np.all(given == first):
        return first
    known = np.where(np.isfinite(given), given, np.nan) + 0.0
    with np.errstate(over="ignore"):
        return mark + b64encode(known.astype(form).tobytes()).decode("ascii")


def safe(text: str) -> str:
    """Return text without markup, for elements and attributes.

    >>> safe('<b> & "c"')
    '&lt;b&gt; &amp; &quot;c&quot;'
    """
    return escape(_FORBIDDEN.sub("\ufffd", text))


def breakable(text: str) -> str:
    """Return a name as text that may be broken after its dots and underscores.

    >>> breakable("bar.angular_velocity")
    'bar.<wbr>angular_<wbr>velocity'
    """
    return _BREAK.sub(r"\1<wbr>", safe(text))


def element(tag: str, inside: str = "", **attributes: str | None) -> str:
    """Return an element. `inside` is markup, attributes are texts, and one that is None is left out.

    >>> element("td", "1.0", class_="number", data_sort="1.03")
    '<td class="number" data-sort="1.03">1.0</td>'
    """
    return f"<{tag}{_written(attributes)}>{inside}</{tag}>"


def _written(attributes: dict[str, str | None]) -> str:
    pairs = ((name.rstrip("_").replace("_", "-"), value) for name, value in attributes.items() if value is not None)
    return "".join(f' {name}="{safe(value)}"' for name, value in pairs)


def lines(parts: Iterable[str]) -> str:
    """Return pieces of markup, one below the other."""
    return "\n".join(part for part in parts if part)


def screen_reader_text(text: str) -> str:
    """Return text for screen readers only."""
    return element("span", safe(text), class_="unseen")


def data_script(name: str, value: Any) -> str:
    """Write data for scripts, found by the id `name`; no text in it can end the element."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return f'<script type="application/json" id="{safe(name)}">{embedded(text)}</script>'


def embedded(text: str) -> str:
    r"""Write JSON that cannot end the element around it: "<" is escaped.

    >>> embedded('{"a":"</script>"}')
    '{"a":"\\u003c/script>"}'
    """
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
