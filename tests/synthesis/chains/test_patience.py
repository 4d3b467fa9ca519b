"""What would take minutes says so at once, and what to do instead."""

from __future__ import annotations

import pytest

import compoundkin as ck
from compoundkin.chains import chains, chains_of, inversions, trusses
from compoundkin.synthesis.chains import generation


@pytest.mark.parametrize(
    "call",
    [
        lambda: trusses(13),
        lambda: chains(12),
        lambda: chains(100),
        lambda: inversions(14),
        lambda: chains_of(13, mobility=0),
        lambda: chains_of(20, mobility=5),
    ],
)
def test_more_chains_than_are_made_in_seconds_are_refused(call) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"take half a minute to hours; ask for 1[01], or be patient=True"):
        call()


def test_the_patient_get_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(generation, "MOST_MADE", {1: 6})
    with pytest.raises(ck.errors.InvalidInput, match="ask for 6"):
        chains_of(8)
    assert len(chains_of(8, patient=True)) == 16
