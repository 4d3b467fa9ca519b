"""Reports: what a lecturer would draw on the board, as data, and as text, Markdown, JSON and pages."""

from __future__ import annotations

from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.whole_report import page, report

__all__ = ["Report", "page", "report"]
