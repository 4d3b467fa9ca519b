"""Pages: a report with its pictures as one HTML file that needs nothing else."""

from __future__ import annotations

from compoundkin.view.page.report_page import Page, page_of
from compoundkin.view.page.viewer import framed_player, player

__all__ = ["Page", "framed_player", "page_of", "player"]
