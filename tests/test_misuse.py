"""Words used wrongly: what is said is about the word that was written, and says how to mend it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import compoundkin as ck

SIX_BAR = ck.solve(ck.load("six-bar"))

LINKS = (ck.link("frame", A=0, D=4), ck.link("coupler", A=0, B=1))
TURNS = ck.laws.program(ck.laws.rise(1.0, over=3.0))

REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "a list of names": (lambda: SIX_BAR.table(["G.velocity"]), "one text for each"),
    "a number for a name": (lambda: ck.quantity(SIX_BAR, 3), "3 is no text"),
    "a list of names to plot": (lambda: ck.plot(SIX_BAR, ["G", "bar"]), "one text for each"),
    "a list of kinds": (lambda: ck.draw(SIX_BAR, kind=["groups"]), "is no text; write one text"),
    "vectors switched on": (lambda: ck.draw(SIX_BAR, kind="polygon", vectors=True), "velocity, acceleration"),
    "a name for the place of a picture": (lambda: ck.draw(SIX_BAR, "coupler"), "'coupler' is not a number"),
    "a vector in an infinite direction": (lambda: ck.polar(1.0, -float("inf")), "angle: infinite numbers"),
    "an infinite vector": (lambda: ck.polar(float("inf"), 0.0), "radius: infinite numbers"),
    "ends of an arc switched off": (
        lambda: ck.Mechanism("t", *LINKS, ck.arc("coupler", on="frame", at="B", centre_at="D", radius=1, reach=False)),
        "False is not two ends",
    ),
    "an empty array of units": (lambda: ck.Mechanism("t", *LINKS, units=np.array([])), "does not name units"),
    "an integer of more than 64 bits": (
        lambda: ck.profiles.constant_breadth(TURNS, base=4.0, angle=2**70),
        "angle: .* is not a finite number",
    ),
    "vectors of an animation switched on": (lambda: ck.animate(SIX_BAR, vectors=True), "velocity, acceleration"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused_with_a_remedy(case: str) -> None:
    call, told = REFUSED[case]
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        call()


@pytest.mark.parametrize("word", ["slide", "slot", "arc", "cam", "face", "gear", "belt", "rack", "roll", "roll_around"])
def test_arguments_that_lack_are_told_of_the_word_not_of_its_class(word: str) -> None:
    with pytest.raises(TypeError, match=rf"^{word}\(\): missing a required"):
        getattr(ck, word)()


def test_a_word_that_there_is_not_is_told_of_the_function_that_was_called() -> None:
    with pytest.raises(TypeError, match=r"^with_driver\(\) got an unexpected keyword argument 'colour'"):
        ck.with_driver(SIX_BAR.mechanism, "bar", colour=-1)
