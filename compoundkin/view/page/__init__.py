"""Pages: a report with its pictures as one HTML file that needs no other file and no network.

The Content-Security-Policy of a page forbids every request. All text of a user goes through `safe`, all data for
scripts through `data_script`. Reading needs no scripts; they add motion, highlighting, sorting and copying. Elements
about links name them in `data-links`. Scripts share one object, `compoundkin`, and communicate by events of the
document: `compoundkin:pose` (an index into the motion's poses), `compoundkin:light`, `compoundkin:theme`. Tables hold
the rounded text and every digit. Formulas become MathML by `mathml`.
"""

from __future__ import annotations

from compoundkin.view.page.report_page import Page, page_of
from compoundkin.view.page.viewer import framed_player, player

__all__ = ["Page", "framed_player", "page_of", "player"]
