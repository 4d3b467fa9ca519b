"""The page of one design of many: what it is of that design alone, and as quickly made."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import compoundkin as ck
from tests.benchmarks import six_bar

DESIGNS, SHOWN = 20_000, 777


def timed(call: Callable[[], ck.results.Page]) -> tuple[str, float]:
    """A page without the line that says which design it is of, and the seconds of the processor it took."""
    start = time.process_time()
    html = call().html
    seconds = time.process_time() - start
    told = f"<p>Shown is design {SHOWN} of {DESIGNS:,} (counted from 0); the checks are of it alone.</p>\n"
    return html.replace(told, ""), seconds


def test_a_page_of_one_of_20_000_designs_takes_as_long_as_of_one() -> None:
    """All other designs were solved, checked and searched for extremes before: minutes, and all memory."""
    lengths, crank = np.linspace(26.0, 30.0, DESIGNS)[:, None], np.linspace(0.0, 2.0 * np.pi, 19)
    many = ck.solve(six_bar.mechanism(rocker=lengths), {"crank": crank}, speed=six_bar.SPEED)
    one = ck.solve(six_bar.mechanism(rocker=float(lengths[SHOWN, 0])), {"crank": crank}, speed=six_bar.SPEED)
    timed(lambda: ck.page(one))
    alone, seconds = timed(lambda: ck.page(one))
    picked, needed = timed(lambda: ck.page(many, design=SHOWN))
    assert "design 777" not in picked
    assert picked == alone
    assert needed < 2.5 * seconds


def test_a_mechanism_of_many_designs_is_solved_for_one() -> None:
    """Report and picture, of which the drivers' own ranges are solved."""
    lengths = np.linspace(26.0, 30.0, DESIGNS)[:, None]
    many, one = (six_bar.mechanism(rocker=length) for length in (lengths, float(lengths[SHOWN, 0])))
    made = ck.report(many, design=SHOWN)
    assert made.outcome == ck.report(one).outcome
    assert made.section("outputs") == ck.report(one).section("outputs")
    assert ck.draw(many, at=0.5, design=SHOWN, paths="G").svg == ck.draw(one, at=0.5, paths="G").svg
