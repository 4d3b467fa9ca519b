"""linkage_sim: bodies with axes of their own, in any pose or none, come to the same motion."""

from __future__ import annotations

import cmath
import json
import warnings
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Imported
from compoundkin.files.exchange.linkage_sim import FORMAT
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from tests.catalog import mechanism as loaded
from tests.files.exchange.pages import prints_what_it_shows
from tests.files.exchange.references import entry, holds

SAMPLE = entry("linkage_sim_four_bar")


def read(data: Any) -> Imported:
    content = Content(json.dumps(data).encode())
    assert FORMAT.recognises(content)
    return FORMAT.read(content)


def test_the_sample_has_its_numbers() -> None:
    found = read(json.loads(SAMPLE["text"]))
    mechanism, expected = found.mechanism, SAMPLE["expected"]
    holds(mechanism, SAMPLE)
    (drive,) = mechanism.drives
    assert (drive.link, drive.speed, mechanism.unit) == (expected["driver"], expected["speed_rad_s"], expected["unit"])
    assert f"of {expected['modes']}; all are found" in found.notes[0]
    assert mechanism.masses["coupler"].mass == 0.2
    assert mechanism.masses["coupler"].at == 0.02


class Written:
    """A mechanism as linkage_sim would save it: each body in axes of its own, or all in those of the pose shown."""

    def __init__(self, shown: PosedMechanism, rng: np.random.Generator | None) -> None:
        self.shown, links = shown, shown.mechanism.rigid_links
        self.axes = dict.fromkeys(links, (0.0, 0j))
        if rng is not None:
            self.axes |= {k: (rng.uniform(-3, 3), complex(*rng.normal(size=2))) for k in links if k != "frame"}
        weightless = {"mass": 0.0, "cg_local": [0, 0], "izz_cg": 0.0}
        self.bodies: dict[str, Any] = {}
        for name, link in links.items():
            points = {k: self.of(name, shown.place(name, k)) for k in link.letters}
            self.bodies[self.called(name)] = {"attachment_points": points, **weightless}
        self.joints: dict[str, Any] = {}
        for letter, (first, *others) in shown.mechanism.carriers.items():
            for other in others:
                self.joint("revolute", first, letter, other, letter)
        for pair in shown.pairs:
            (on, link), (line, _) = pair.members, shown.ends[pair.name]
            self.bodies[self.called(on)]["attachment_points"][f"{pair.name} line"] = self.of(
                on, shown.place(on, line.point)
            )
            self.joint("prismatic", on, f"{pair.name} line", link, pair.letters[0])
            along = shown.direction(on, line.direction) * cmath.exp(-1j * self.axes[on][0])
            turn = self.axes[link][0] - self.axes[on][0]
            self.joints[f"J{len(self.joints)}"] |= {"axis_local_i": [along.real, along.imag], "delta_theta_0": turn}
        self.drivers = {
            one.name: {"type": "constant_speed", "body_i": self.called(one.on), "body_j": self.called(one.link),
                       "omega": 2.0, "theta_0": self.axes[one.link][0] - self.axes[one.on][0]}
            for one in shown.mechanism.drives}  # fmt: skip

    def called(self, link: str) -> str:
        return "ground" if link == "frame" else link

    def of(self, link: str, place: complex) -> list[float]:
        """A place of the pose shown in a body's axes, which are turned and moved in that pose."""
        turn, origin = self.axes[link]
        own = (place - origin) * cmath.exp(-1j * turn)
        return [own.real, own.imag]

    def joint(self, kind: str, first: str, point: str, second: str, other: str) -> None:
        self.joints[f"J{len(self.joints) + 1}"] = {"type": kind, "body_i": self.called(first), "point_i": point,
                                                   "body_j": self.called(second), "point_j": other}  # fmt: skip

    def split(self, link: str, letter: str) -> None:
        """Make two bodies of a link, fixed to each other at a point."""
        points = self.bodies[link]["attachment_points"]
        moved = {key: (complex(*place) - 1 - 2j) * cmath.exp(-0.7j) for key, place in points.items()}
        self.bodies["half"] = {"attachment_points": {key: [place.real, place.imag] for key, place in moved.items()}}
        for joint in self.joints.values():
            for side in "ij":
                if (joint[f"body_{side}"], joint[f"point_{side}"]) == (link, letter):
                    joint[f"body_{side}"] = "half"
        self.joints["weld"] = {"type": "fixed", "body_i": "half", "body_j": link, "point_i": letter, "point_j": letter,
                               "delta_theta_0": -0.7}  # fmt: skip

    @property
    def data(self) -> dict[str, Any]:
        return {"schema_version": "1.1.0", "bodies": self.bodies, "joints": self.joints, "drivers": self.drivers}


def same_motion(shown: PosedMechanism, other: ck.Mechanism, step: float = 0.05) -> None:
    """Compare two mechanisms a little on from the pose shown."""
    mechanism = shown.mechanism
    places = {k: shown.place(links[0], k) for k, links in mechanism.carriers.items()}
    starts = {drive.name: np.ravel(drive.values)[0] for drive in other.drives}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        one = ck.solve(mechanism, {k: value + step for k, value in shown.values.items()}, hint=places, order=0)
        two = ck.solve(other, {k: value + step for k, value in starts.items()}, hint=places, order=0)
    for letter in mechanism.carriers:
        a, b = (motion.points[letter].position for motion in (one, two))
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-9 * one.size)


# A slide on a moving link, a driver between two, a pin of three links and class III among them.
NAMES = ("slider-crank-offset", "six-bar", "hand-pump", "peaucellier", "class-iii-six-bar")


@pytest.mark.parametrize("name", NAMES)
def test_bodies_in_axes_of_their_own_and_as_drawn(name: str) -> None:
    shown = posed_mechanism(loaded(name))
    found = read(Written(shown, np.random.default_rng(3)).data)
    assert any("no pose is in the file" in note for note in found.notes)
    same_motion(shown, found.mechanism)
    drawn = read(Written(shown, None).data)
    assert any("taken as the pose drawn" in note for note in drawn.notes)
    same_motion(shown, drawn.mechanism)
    again = posed_mechanism(drawn.mechanism)
    for letter, links in shown.mechanism.carriers.items():
        assert abs(again.place(links[0], letter) - shown.place(links[0], letter)) < 1e-9 * shown.mechanism.geometry.size


def test_fixed_joints_make_one_link_and_masses_are_added() -> None:
    shown = posed_mechanism(loaded("watt-i"))
    link = next(name for name, one in shown.mechanism.links.items() if name != "frame" and len(one.letters) == 3)
    written = Written(shown, np.random.default_rng(5))
    written.split(link, shown.mechanism.links[link].letters[2])
    written.bodies[link] |= {"mass": 2.0, "cg_local": [1.0, 0.0], "izz_cg": 0.5}
    half = {
        "mass": 1.0,
        "cg_local": [0.0, 3.0],
        "izz_cg": 0.25,
        "point_masses": [{"mass": 3.0, "local_pos": [2.0, 2.0]}],
    }
    written.bodies["half"] |= half
    data = written.data | {"forces": [{"type": "Gravity", "g_vector": [0, -9.81]}, {"type": "GasSpring"}]}
    found = read(data)
    assert set(found.mechanism.links) - {"half"} == set(shown.mechanism.links)
    same_motion(shown, found.mechanism)
    # the second body's axes in the first's: turned by 0.7, at 1 + 2i
    parts = [
        (2.0, 1 + 0j, 0.5),
        (1.0, 1 + 2j + 3j * cmath.exp(0.7j), 0.25),
        (3.0, 1 + 2j + (2 + 2j) * cmath.exp(0.7j), 0.0),
    ]
    centre = sum(m * z for m, z, _ in parts) / 6.0
    ((name, item),) = found.mechanism.masses.items()
    at = complex(item.at)
    if name != link:
        at = 1 + 2j + at * cmath.exp(0.7j)
    assert (item.mass, at) == (pytest.approx(6.0), pytest.approx(centre))
    assert item.inertia == pytest.approx(sum(own + m * abs(z - centre) ** 2 for m, z, own in parts))
    assert found.mechanism.gravity == -9.81j
    assert found.notes[0] == "left out: 1 GasSpring"
    data["joints"]["weld 2"] = data["joints"]["weld"] | {"delta_theta_0": 1.0}
    with pytest.raises(InvalidInput, match=r"joint weld 2: it fixes .* where another fixed joint does not"):
        read(data)


def test_springs_dampers_and_forces_do_the_work_that_their_formulas_say() -> None:
    data = json.loads(SAMPLE["text"])
    ends = {"body_a": "coupler", "point_a": [0.04, 0.02], "body_b": "ground", "point_b": [9, 9], "point_b_name": "O4"}
    turned = {"body_i": "rocker", "body_j": "coupler"}
    data["forces"] = [
        {"type": "LinearSpring", **ends, "stiffness": 700.0, "free_length": 0.03},
        {"type": "TorsionSpring", **turned, "stiffness": 0.3, "free_angle": -0.4},
        {"type": "LinearDamper", **ends, "damping": 11.0},
        {"type": "RotaryDamper", **turned, "damping": 0.02},
        {"type": "ExternalForce", "body_id": "coupler", "local_point": [0.01, -0.02], "force": [3.0, -5.0]},
        {"type": "ExternalTorque", "body_id": "rocker", "torque": 0.7, "modulation": {"modulation_type": "Constant"}},
        {"type": "ExternalTorque", "body_id": "rocker", "torque": 9.0, "modulation": {"modulation_type": "Step"}},
    ]
    found = read(data)
    assert found.notes[0] == "left out: 1 ExternalTorque"
    motion = ck.solve(found.mechanism, {"D1": [1.1]}, speed=2.0)
    forces = ck.force_analysis(motion, inertia=False)
    coupler, rocker = motion.links["coupler"], motion.links["rocker"]

    def at(place: complex) -> tuple[complex, complex]:
        arm = place * np.exp(1j * coupler.angle)
        start = motion.points["B"]
        return start.position + arm, start.velocity + 1j * coupler.angular_velocity * arm

    (end, speed), (_, moved) = at(0.04 + 0.02j), at(0.01 - 0.02j)
    way, turn = end - 0.05, rocker.angular_velocity - coupler.angular_velocity
    rate = (speed * way.conjugate()).real / abs(way)
    between = np.angle(np.exp(1j * (coupler.angle - rocker.angle + 0.4)))
    power = -700.0 * (abs(way) - 0.03) * rate - 11.0 * rate**2 - 0.02 * turn**2 + 0.7 * rocker.angular_velocity
    power += 0.3 * between * turn + 3.0 * moved.real - 5.0 * moved.imag
    assert forces.drives["D1"].effort * 2.0 == pytest.approx(-power, rel=1e-9)


def test_a_linear_driver_is_a_cylinder() -> None:
    data = json.loads(SAMPLE["text"])
    del data["drivers"]
    found = read(data)
    assert found.mechanism.drives == ()
    assert "no driver is in the file" in found.notes[0]
    ends = {"body_a": "rocker", "point_a": [0.02, 0], "body_b": "ground", "point_b": [0.0, 0.05]}
    data["linear_drivers"] = [{"id": "ram", **ends, "velocity": 0.01, "length_0": 0.06}]
    mechanism = read(data).mechanism
    motion = ck.solve(mechanism)
    lengths = np.abs(motion.points["ram 1"].position - motion.points["ram 2"].position)
    assert lengths == pytest.approx(np.linspace(0.06, 0.06 + 0.1 * 0.053851648071345036, 73))


REFUSED = [
    (lambda d: d["joints"]["J1"].update(type="cam_follower"), "joint J1: joints of the type 'cam_follower' are not"),
    (lambda d: d["joints"]["J1"].update(point_i="X"), "the body 'ground' has no point 'X'; it has O2, O4"),
    (lambda d: d["joints"]["J1"].update(body_i="base"), "there is no body 'base'"),
    (lambda d: d["bodies"].pop("ground"), "there is no body 'ground'"),
    (lambda d: d["drivers"]["D1"].update(type="expression", expr="__import__('os')"), "which is not evaluated"),
    (lambda d: d["drivers"]["D1"].update(body_i="rocker"), "and no revolute joint joins them"),
    (lambda d: d.update(schema_version="2.0.0"), "'2.0.0' is not known"),
    (lambda d: d["bodies"]["crank"]["attachment_points"].update(B=[0]), "body crank, attachment_points: 'B' is"),
    (lambda d: d["joints"].update(J5={**d["joints"]["J2"], "point_i": "A"}), "joints hold two of its points at"),
    (lambda d: d["joints"].clear(), "there are no joints"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_cannot_be_meant_is_refused_by_name(change: Any, words: str) -> None:
    data = json.loads(SAMPLE["text"])
    change(data)
    with pytest.raises(InvalidInput) as error:
        read(data)
    assert words in str(error.value)


def test_its_page_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    prints_what_it_shows("linkage-sim.md", capsys)
