"""The linkage of lower pairs that stands for higher ones: velocities and accelerations at one pose, structure."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.equivalents import equivalent_linkage, replaced
from compoundkin.model.elements import Link
from compoundkin.model.pairs import Pair
from tests import catalog

# the geared five-bars do not close all round
pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")


def oval() -> ck.profiles.Profile:
    return ck.profiles.formula(lambda s: 30 * np.cos(s) + 1j * 22 * np.sin(s) + 4, 0, 2 * np.pi)


def cam_with(*items: Pair | Link) -> ck.Mechanism:
    frame = ck.link("frame", A=(0, 0), X=(6, 0), H=(60, 10))
    return ck.Mechanism("Cam", frame, ck.link("cam", A=0, M=8), *items, ck.drive("cam", speed=7.0))


def five_bar(wheels: Pair) -> ck.Mechanism:
    return ck.Mechanism(
        "Five-bar",
        ck.link("frame", A=(0, 0), D=(6, 0)),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=7),
        ck.link("arm", C=0, E=9),
        ck.link("wheel", D=0, E=4),
        wheels,
        ck.drive("crank", speed=7.0),
    )


GUIDE = ck.slide("follower", on="frame", through="X", angle=np.pi / 2)
ARM = ck.link("follower", H=0, P=50)
CASES = {
    "oscillating roller": cam_with(ARM, ck.cam("follower", on="cam", at="P", profile=oval(), radius=5)),
    "translating face": cam_with(
        ck.link("follower", P=0), GUIDE, ck.face("follower", on="cam", profile=oval(), angle=-np.pi / 2, side=-1)
    ),
    "oscillating face": cam_with(ck.link("follower", H=0, P=6j), ck.face("follower", on="cam", at="P", profile=oval())),
    "roller of its own": cam_with(
        ck.link("follower", P=0), ck.link("roller", P=0), GUIDE, ck.cam("roller", on="cam", profile=oval(), radius=5)
    ),
    "arc": cam_with(ck.link("follower", P=0), GUIDE, ck.arc("follower", on="cam", centre_at="M", radius=30)),
    "slot": ck.Mechanism(
        "Quick return",
        ck.link("frame", A=(0, 0), C=(0, -40)),
        ck.link("crank", A=0, B=15),
        ck.link("arm", C=0, T=80),
        ck.slot("crank", on="arm", at="B", through="C", toward="T"),
        ck.drive("crank", speed=7.0),
    ),
    "gears": five_bar(ck.gear("crank", "wheel", radii=(4, 2), phase=0.5)),
    "open belt": five_bar(ck.belt("crank", "wheel", radii=(2, 1), phase=0.5)),
    "crossed belt": five_bar(ck.belt("crank", "wheel", radii=(2, 1), phase=0.5, crossed=True)),
    "chain by teeth": five_bar(ck.belt("crank", "wheel", teeth=(20, 10), phase=0.5)),
    "internal gear": ck.Mechanism(
        "Planet",
        ck.link("frame", A=0),
        ck.link("arm", A=0, P=10),
        ck.link("planet", P=0, Q=10),
        ck.link("ring", A=0, R=4),
        ck.gear("planet", "ring", carrier="arm", teeth=(20, 40), internal=True),
        ck.drive("arm", speed=7.0),
        ck.drive("ring", values=0.0, speed=0.3),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_same_velocities_and_accelerations(name: str) -> None:
    """Solved by dyads of pins and slides only, the linkage moves as the cams and gears do."""
    motion = ck.solve(CASES[name])
    for at in (3, 17, 40):
        linkage = equivalent_linkage(motion, at)
        assert all(pair.held == 2 for pair in linkage.written_pairs)
        other = ck.solve(linkage)
        for link in (link for link in linkage.links if link in motion.mechanism.links):
            one, two = motion.links[link], other.links[link]
            assert abs(one.angular_velocity.flat[at] - two.angular_velocity.flat[0]) < 1e-12 * 7
            assert abs(one.angular_acceleration.flat[at] - two.angular_acceleration.flat[0]) < 1e-11 * 49
        for letter in CASES[name].carriers:
            one, two = motion.points[letter], other.points[letter]
            for k, limit in ((0, 1e-13), (1, 1e-12 * 7), (2, 1e-11 * 49)):
                gap = complex(one.derivative(k).flat[at]) - complex(two.derivative(k).flat[0])
                assert abs(gap) < limit * motion.size


@pytest.mark.parametrize(
    ("name", "groups"),
    [("oscillating roller", ["RRR"]), ("translating face", ["RPP"]), ("oscillating face", ["RPR"]),
     ("roller of its own", ["RRP"]), ("slot", ["RPR"]), ("gears", ["RRR", "RRR"])],
)  # fmt: skip
def test_its_groups_are_dyads(name: str, groups: list[str]) -> None:
    linkage = equivalent_linkage(ck.solve(CASES[name]), 3)
    assert [group.name for group in ck.decompose(linkage).groups] == groups
    assert ck.decompose(linkage).mobility.freedoms == 1


def test_it_has_the_mobility_of_the_mechanism() -> None:
    """A link and two lower pairs hold as much as one higher pair."""
    for mechanism in CASES.values():
        linkage = equivalent_linkage(ck.solve(mechanism), 3)
        assert ck.decompose(linkage).mobility.freedoms == ck.decompose(mechanism).mobility.freedoms


def test_the_centres_of_curvature_of_an_ellipse() -> None:
    """The bar of a knife edge on an ellipse is its radius of curvature, (a^2 sin^2 + b^2 cos^2)^(3/2) / (a b)."""
    mechanism = cam_with(ck.link("follower", P=0), GUIDE, ck.cam("follower", on="cam", profile=oval()))
    motion = ck.solve(mechanism)
    for at in (3, 17, 40):
        (found,) = replaced(motion, at)[1]
        seen = complex(motion.points["P"].position.flat[at]) * np.exp(-1j * motion.links["cam"].angle[at]) - 4
        s = np.arctan2(seen.imag / 22, seen.real / 30)
        radius = (900 * np.sin(s) ** 2 + 484 * np.cos(s) ** 2) ** 1.5 / (30 * 22)
        assert found.length == pytest.approx(radius, rel=1e-9)


def test_a_pose_that_is_not_assembled_is_refused() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="pose 99"):
        equivalent_linkage(ck.solve(CASES["slot"]), 99)


def test_without_higher_pairs_nothing_is_replaced() -> None:

    motion = catalog.motion("six-bar")
    assert replaced(motion)[1] == ()
    linkage = ck.solve(equivalent_linkage(motion, 5))
    assert abs(complex(linkage.points["G"].velocity) - complex(motion.points["G"].velocity[5])) < 1e-11
