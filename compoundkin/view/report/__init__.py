"""Reports: what a lecturer would draw on the board, as data, and as text, Markdown and JSON."""

from __future__ import annotations

from compoundkin.view.report.renderers import FORMATS, rendered
from compoundkin.view.report.report_data import Report
from compoundkin.view.report.structure_report import report

__all__ = ["FORMATS", "Report", "rendered", "report"]
