"""Tables of operations as data for the machine of a page."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.programs.tables.operation_table import CODES, OperationTable

# Whole numbers up to this are written in two bytes.
SHORT = 2**15


def table_data(table: OperationTable) -> dict[str, Any]:
    """Return a table as the script machine.js takes it."""
    return {
        "codes": list(CODES),
        "constants": list(map(_number, table.constants)),
        "numbers": table.numbers,
        "rows": table.rows,
        "before": whole(table.before),
        "along": whole(table.along),
    }


def _number(value: float) -> float | str:
    """Return a number as JSON has it; what is not finite as a text that a script reads."""
    return value if np.isfinite(value) else str(value).replace("inf", "Infinity").replace("nan", "NaN")


def whole(numbers: Sequence[int]) -> str:
    """Pack whole numbers, two bytes each where these are enough, else four.

    >>> whole([1, -2])
    'h:AQD+/w=='
    """
    form, mark = ("<i2", "h:") if max(map(abs, numbers), default=0) < SHORT else ("<i4", "i:")
    return mark + b64encode(np.array(numbers, form).tobytes()).decode("ascii")
