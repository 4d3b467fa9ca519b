"""The oracle: `python -m tests.oracle record FILE` what the program says, later `compare FILE [FILE2]` with it."""

from __future__ import annotations

import sys
import time

import click

from tests.oracle.comparison import Comparison
from tests.oracle.record import read, recorded, written

QUICK = click.option("--quick", is_flag=True, help="The catalog and some random mechanisms, no pictures, no texts.")
ONLY = click.option("--only", default="", metavar="PART", help="One part of the record, such as configurations.")
CASES = click.option("--cases", "named", default="", metavar="NAME", help="The cases whose name contains this.")


@click.group()
def oracle() -> None:
    """Records what the program says, and shows what it says otherwise later."""


@oracle.command()
@click.argument("file")
@QUICK
@ONLY
@CASES
def record(file: str, quick: bool, only: str, named: str) -> None:
    """Record what the program says."""
    began = time.perf_counter()
    count = written(file, recorded(quick, only, named))
    click.echo(f"{count} lines in {time.perf_counter() - began:.0f} s: {file}")


@oracle.command()
@click.argument("file")
@click.argument("other", default="")
@QUICK
@ONLY
@CASES
@click.option("--looser", default=1.0, metavar="FACTOR", help="Tolerances so many times as large.")
@click.option("--most", default=8, metavar="COUNT", help="Show so many differences of each line.")
def compare(file: str, other: str, quick: bool, only: str, named: str, looser: float, most: int) -> None:
    """Compare a record with another, or with what the program says now; exit code 1 where they differ."""
    comparison = Comparison(looser, most)
    partly = quick or bool(only or named)
    now = read(other) if other else recorded(quick, only, named)
    comparison.compare(read(file), now, partly)
    click.echo(comparison.summary())
    sys.exit(1 if comparison.different else 0)


if __name__ == "__main__":
    oracle()
