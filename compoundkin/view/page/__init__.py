"""Pages: a report with its pictures as one HTML file that needs nothing else."""

from __future__ import annotations

from compoundkin.view.page.player import framed, player
from compoundkin.view.page.report_page import Page, page_of

__all__ = ["Page", "framed", "page_of", "player"]
