"""Pages: a report with its pictures as one HTML file that needs nothing else."""

from __future__ import annotations

from compoundkin.pages.making import Page, page, page_of
from compoundkin.pages.playing import framed, player

__all__ = ["Page", "framed", "page", "page_of", "player"]
