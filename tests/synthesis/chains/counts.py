"""Published and independently computed numbers of chains, by case."""

from __future__ import annotations

import json
from pathlib import Path

COUNTS = {
    case["id"]: case["expected"]
    for case in json.loads((Path(__file__).parents[2] / "reference" / "counts.json").read_text(encoding="utf-8"))
}
