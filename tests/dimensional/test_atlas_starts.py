"""Designs of an atlas as starts of `optimise`: in another's coordinates they trace the curves of the atlas."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dimensional.atlas_starts import designs_for
from compoundkin.dimensional.curve_chains import curve_chains, turn
from compoundkin.dimensional.curve_likeness import coefficients, likeness
from compoundkin.errors import InvalidInput

# Links in other coordinates than those of the atlas, with other names and letters.
FOUR_BAR = ck.Mechanism(
    "Mine",
    ck.link("frame", O=(1, 2), Q=(1, 7)),
    ck.link("input", O=(0, 0), R=(0, 2)),
    ck.link("plate", S=(4, 0), R=(-1, 0), T=(1, 2)),
    ck.link("arm", Q=(0, 0), S=(3, 3)),
    ck.drive("input"),
)
SIX_BAR = ck.Mechanism(
    "Six",
    ck.link("frame", O=(0, 0), Q=(4, 0), V=(2, 5)),
    ck.link("input", O=(0, 0), R=(1, 0)),
    ck.link("plate", R=(0, 0), S=(4, 0), U=(2, 2)),
    ck.link("arm", Q=(0, 0), S=(4, 0)),
    ck.link("bar", U=(0, 0), W=(5, 0), T=(1, 1)),
    ck.link("end", V=(0, 0), W=(5, 0)),
    ck.drive("input"),
)
SLIDER = ck.Mechanism(
    "Sliding",
    ck.link("frame", O=(0, 0)),
    ck.link("input", O=(0, 0), R=(2, 0)),
    ck.link("plate", R=(0, 0), S=(0, 6), T=(1, 1)),
    ck.link("block", S=(0, 0)),
    ck.slide("block", on="frame", at="S", through="O", angle=0.0, offset=0.5, name="way"),
    ck.drive("input"),
)
WIDE = 1e6
FREE = {
    "Mine": ["input.R.y", "plate.S.x", "plate.T", "arm.S.x", "arm.S.y", "frame.Q"],
    "Six": ["input.R.x", "plate.S.x", "plate.U", "arm.S.x", "bar.W.x", "bar.T", "end.W.x", "frame.V"],
    "Sliding": ["input.R.x", "plate.S.y", "plate.T", "way.offset"],
}
# A link whose second point is at another angle keeps its direction by one coordinate alone.
FREE["Mine"].remove("plate.S.x")
FREE["Mine"].append("plate.S")


def ranges_of(mechanism: ck.Mechanism) -> dict[str, tuple[complex, complex]]:
    points = ("plate.T", "frame.Q", "plate.U", "bar.T", "frame.V", "plate.S")
    wide = dict.fromkeys(points, (-WIDE - WIDE * 1j, WIDE + WIDE * 1j))
    return {name: wide.get(name, (-WIDE + 0j, WIDE + 0j)) for name in FREE[mechanism.title]} | (
        {"frame.Q": (3 + 4j, 3.5 + 9j)} if mechanism is FOUR_BAR else {}
    )


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
@pytest.mark.parametrize("mechanism", [FOUR_BAR, SIX_BAR, SLIDER], ids=lambda one: one.title)
def test_designs_trace_the_curves_of_the_atlas(mechanism: ck.Mechanism) -> None:
    title = {"Mine": "Four-bar", "Six": "Stephenson III", "Sliding": "Slider-crank"}[mechanism.title]
    chain = next(one for one in curve_chains() if one.title == title)
    designs = chain.designs(np.random.default_rng(4).random((8192, len(chain.numbers))))
    z, clear = chain.curves(designs, 128)
    designs, wanted = designs[clear][:6], coefficients(z[clear][:6])[0]
    values = designs_for([(chain, lambda: designs)], mechanism, ranges_of(mechanism), 0)
    count = len(next(iter(values.values())))
    assert count == 12  # each as it is and mirrored
    best = np.zeros(6)
    moving = [one.links[-1] for one in ck.decompose(mechanism).groups]
    for signs in product((1, -1), repeat=len(moving)):
        program = ck.compile(mechanism, ["T.position"], free=list(values), modes=dict(zip(moving, signs, strict=True)))
        for k in range(count):
            own = {name: value[k] for name, value in values.items()}
            found = np.ravel(program(turn(128), own)["T.position"])
            if np.isfinite(found).all():
                alike = likeness(coefficients(found[None])[0], wanted[k % 6])[0][0]
                best[k % 6] = max(best[k % 6], alike)
    np.testing.assert_allclose(best, 1.0, atol=1e-3)  # starts are tried in 64 steps


def test_searches_begin_at_designs_that_turn_and_find_what_is_hidden() -> None:
    free = {"input.R.y": (0.5, 3.0), "plate.T": ((-6, -6), (6, 6)), "arm.S.x": (1.0, 6.0)}
    hidden = {"input.R.y": 1.4, "plate.T": 1.5 - 2.5j, "arm.S.x": 3.4}
    places = np.ravel(ck.compile(FOUR_BAR, "T.position", free=list(hidden))(turn(24), hidden)["T.position"])
    found = ck.optimise(FOUR_BAR, free, ck.goals.trace("T", places), values=turn(36), atlas=ck.coupler_atlas(4, 2_000))
    assert found.check.passed
    for name, value in hidden.items():
        assert found.dimensions[name] == pytest.approx(value, abs=1e-6)


def test_what_is_no_chain_or_has_no_room_is_said() -> None:
    atlas = ck.coupler_atlas(4, 500)
    goal = ck.goals.trace("T", [0, 1, 1 + 1j, 1j, 0.5j])
    with pytest.raises(InvalidInput, match="Six is no chain of this atlas, whose linkages have 4 links"):
        ck.optimise(SIX_BAR, {"bar.W.x": (4, 6)}, goal, values=turn(12), atlas=atlas)
    with pytest.raises(InvalidInput, match="no design of the atlas lies within the ranges"):
        ck.optimise(FOUR_BAR, {"plate.T": ((90, 90), (91, 91))}, goal, values=turn(12), atlas=atlas)
    with pytest.raises(InvalidInput, match="atlas: 'atlas' is no design atlas; coupler_atlas"):
        ck.optimise(FOUR_BAR, {"arm.S.x": (1, 4)}, goal, atlas="atlas")
    sliding = ck.Mechanism("Slid", *SLIDER.links.values(), *SLIDER.written_pairs, ck.drive("block"))
    with pytest.raises(InvalidInput, match="is no chain of this atlas"):
        ck.optimise(sliding, {"input.R.x": (1, 2)}, goal, values=np.linspace(6.0, 7.0, 12), atlas=atlas)
