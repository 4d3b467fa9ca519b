"""Reports: what a lecturer would write on the board, as data, and as text, Markdown, JSON and pages.

A section is made of blocks (`report_data`); functions that make sections know nothing of forms, and each form is one
`match` over the blocks. Tables hold numbers, their columns how they are written; rounding becomes zero by `floor`.
"""

from __future__ import annotations

from compoundkin.view.report.report_forms import Report
from compoundkin.view.report.whole_report import page, report

__all__ = ["Report", "page", "report"]
