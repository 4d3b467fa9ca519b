"""Reports: what a lecturer would draw on the board, as data, and as text, Markdown and JSON."""

from __future__ import annotations

from compoundkin.reports.building import report
from compoundkin.reports.model import Report
from compoundkin.reports.rendering import FORMATS, rendered

__all__ = ["FORMATS", "Report", "rendered", "report"]
