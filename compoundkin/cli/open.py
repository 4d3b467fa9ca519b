"""`compoundkin open`: the report as a page in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from compoundkin.cli.file_options import made_page, mechanism_argument
from compoundkin.cli.report import asking_options, reported, verdict
from compoundkin.cli.shell import say


@click.command(
    epilog="""\b
Examples:
  compoundkin open six-bar
  compoundkin open linkage.toml --output G.velocity,bar.angle
  compoundkin open six-bar -o six-bar.html
"""
)
@mechanism_argument
@asking_options
@click.option("-o", "--to-file", "path", metavar="PATH", help="Write the page here; else to a temporary file.")
def command(file: str, path: str | None, **asked: Any) -> int:
    """Show the report of a mechanism in the browser. It is one page with the moving sketch, plots and tables.

    The page is a file that needs no network and no server. Exit codes are those of `report`.
    """
    from compoundkin.view.page.report_page import shown_in_browser, temporary

    made, closed = reported(file, asked)
    page = made_page(made)
    target = Path(path) if path else temporary()
    page.save(target)
    if shown_in_browser(target):
        say(f"Opened {target}.")
    else:
        say(f"No browser can be opened here; the page is in {target}.")
    return verdict(made, closed)
