"""Types of four-bars and slider-cranks, by turning every link by every angle, and as catalog and circuits have them."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.characteristics.linkage_types import FourBar, SliderCrank, four_bar_code, linkage_types
from tests import catalog

ANGLES = np.linspace(0.0, 2.0 * np.pi, 721)


def turns(base: np.ndarray, link: np.ndarray, others: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Whether a link closes the loop with the base at every angle: the other two reach over what is between."""
    span = np.abs(base[:, None] - link[:, None] * np.exp(1j * ANGLES))
    return np.all((span <= sum(others)[:, None]) & (span >= np.abs(others[0] - others[1])[:, None]), axis=1)


def test_letters_say_which_links_turn_fully() -> None:
    """Every link is turned through all angles against the base: it is a crank where all of them close."""
    base, one, coupler, other = lengths = np.random.default_rng(1).uniform(0.2, 3.0, (4, 3000))
    codes = four_bar_code(*lengths)
    closed = 2.0 * np.max(lengths, axis=0) < np.sum(lengths, axis=0)
    assert np.array_equal(codes != "", closed)
    for place, (link, rest) in enumerate([(one, (coupler, other)), (coupler, (one, other)), (other, (one, coupler))]):
        letter = np.array([code[1 + place] if code.startswith("G") else "R" for code in codes])
        assert np.array_equal(letter[closed] == "C", turns(base, link, rest)[closed])
    longest = np.array([int(code[3]) for code in codes if code.startswith("RRR")])
    assert np.array_equal(longest, 1 + np.argmax(lengths, axis=0)[np.char.startswith(codes, "RRR")])


def test_change_points_are_named_by_the_shortest_link_or_by_equal_ones() -> None:
    """Barker's cases of s + l = p + q."""
    assert four_bar_code(1, 2, 4, 3) == "SCCC"
    assert four_bar_code([2, 2, 3], [1, 4, 2], [4, 1, 4], [3, 3, 1]).tolist() == ["SCRR", "SRCR", "SRRC"]
    assert four_bar_code([3, 1, 2], [1, 1, 2], [3, 3, 2], [1, 3, 2]).tolist() == ["S2X", "S2X", "S3X"]
    names = [FourBar(("a", "b", "c", "d"), ("A", "B", "C", "D"), lengths, "S2X", "").name
             for lengths in ((3.0, 1.0, 3.0, 1.0), (1.0, 1.0, 3.0, 3.0))]  # fmt: skip
    assert names == ["parallelogram (or antiparallelogram)", "kite (deltoid)"]
    with pytest.raises(ck.errors.InvalidInput, match="the length of a link of a four-bar is positive"):
        four_bar_code(1, 0, 1, 1)


@pytest.mark.parametrize(
    ("name", "types"),
    [
        ("crank-rocker", ["crank-rocker"]),
        ("double-crank", ["double-crank (drag link)"]),
        ("double-rocker", ["Grashof double-rocker"]),
        ("triple-rocker", ["triple-rocker"]),
        ("watt-ii-driven-at-ternary", ["rocker-crank", "triple-rocker"]),
        ("slider-crank", ["in-line slider-crank"]),
        ("slider-crank-offset", ["offset slider-crank"]),
        ("whitworth-turning-guide", ["inverted slider-crank, turning guide"]),
        ("oscillating-guide", ["inverted slider-crank, oscillating guide"]),
        ("crank-shaper", ["inverted slider-crank, oscillating guide", "offset slider-rocker"]),
        ("scott-russell", ["in-line slider-crank, at change points"]),
        ("scotch-yoke", []),
    ],
)
def test_mechanisms_of_the_catalog_are_what_they_are_called(name: str, types: list[str]) -> None:
    assert [one.name for one in linkage_types(catalog.mechanism(name))] == types


@pytest.mark.parametrize(
    "name",
    [
        "crank-rocker",
        "double-crank",
        "double-rocker",
        "four-bar-meriam",
        "slider-crank-offset",
        "watt-ii-driven-at-ternary",
    ],
)
def test_a_driver_turns_fully_where_its_circuits_say_so(name: str) -> None:
    """The first loop holds the driver; circuits are found by continuation, without any length condition."""
    kind = linkage_types(catalog.mechanism(name))[0]
    found = ck.circuits(catalog.structure(name))
    turning = kind.code[1:2] == "C" if isinstance(kind, FourBar) else kind.driven in kind.turns
    assert turning == any(one.turns_fully for one in found.circuits)


def test_slider_cranks_turn_fully_as_turning_them_shows() -> None:
    """The crank where the rod reaches the guide at every angle, a turning guide where its pin goes round it."""
    sines = np.sin(ANGLES)
    for r, rod, e in np.random.default_rng(2).uniform(0.1, 2.0, (40, 3)).tolist():
        at_guide = np.all(np.abs(r * sines - e) <= rod)
        lengths = np.array([r, rod, e])
        kind = SliderCrank(("guide", "crank", "rod", "block"), "g", ("crank", "rod"), (r, rod), e, "crank")
        assert ("crank" in kind.turns) == at_guide, lengths
        inverted = SliderCrank(("crank", "rod", "block", "guide"), "g", ("crank", "rod"), (r, rod), e, "rod")
        turned = np.all(np.abs(r - rod * np.exp(1j * ANGLES)) >= e)
        assert ("rod" in inverted.turns) == turned, lengths
        # the guide's direction from its pivot goes round where the crank is the shorter one
        assert ("guide" in inverted.turns) == (turned and r < rod), lengths


def test_offsets_are_measured_across_the_slide() -> None:
    """An offset in the frame and one in the block; the published quick return has 20 mm."""
    assert linkage_types(catalog.mechanism("slider-crank-offset"))[0].offset == pytest.approx(20.0)
    block = ck.link("block", C=0, E=0.3j)
    links = ck.link("frame", A=0, G=0.5j), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=3), block
    m = ck.Mechanism("m", *links, ck.slide("block", on="frame", at="E", through="G", turn=0.0), ck.drive("crank"))
    found = linkage_types(m)[0]
    assert isinstance(found, SliderCrank)
    assert found.offset == pytest.approx(0.2)
    assert found.margin == pytest.approx(3 - 1 - 0.2)
    assert "SliderCrank(offset slider-crank: crank 1, rod 3" in repr(found)


def test_designs_have_their_own_types() -> None:
    """Two couplers: the second is too short for a crank."""
    links = ck.link("frame", A=0, D=5.5), ck.link("crank", A=0, B=2), ck.link("coupler", B=0, C=([[5.0], [2.0]], 0))
    m = ck.Mechanism("m", *links, ck.link("rocker", C=0, D=4), ck.drive("crank"))
    names = [linkage_types(m, design)[0].name for design in (0, 1)]
    assert names == ["crank-rocker", "triple-rocker"]
    assert "FourBar(crank-rocker, GCRR: frame 5.5" in repr(linkage_types(m)[0])
