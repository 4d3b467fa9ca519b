"""Models for MuJoCo, which closes their loops, moves their points and drives them as we do."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.mjcf.mjcf_format import FORMAT
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from compoundkin.results import Motion
from tests.dynamics.cases import SI
from tests.dynamics.test_mujoco import heavy, some_poses
from tests.files.exchange.mujoco_models import MujocoModel
from tests.files.exchange.references import entry
from tests.files.exchange.shown_catalog import shown
from tests.support import KINDS_OF_DYAD, random_sketch

# What no model can say: cams whose profile is no circle, faces on such, points that are led.
REFUSED = {
    *("conjugate-cams", "constant-breadth-yoke", "disc-cam-roller-program", "five-bar-led", "flat-faced-follower"),
    *("groove-cam-plate", "oscillating-flat-follower", "oscillating-roller-follower"),
}
# Loops at pins; gears, one of them on a carrier that turns; a slot; a rack; halves of links; a tied slide; cylinders.
LOADED = (
    *("class-iii-six-bar", "belt-coupled-cranks", "sun-and-planet", "geneva-wheel", "rack-and-pinion-steering"),
    *("wedge-press", "rolling-wheel", "hydraulic-digger", "quick-return-pin-in-slot"),
)


def good_poses(motion: Motion) -> np.ndarray:
    """Some poses far from limit positions, where rates have all digits."""
    turning = [np.broadcast_to(motion.links[name].angular_velocity, motion.shape) for name in motion.mechanism.links]
    fast = np.max(np.abs(turning), axis=0)
    good = np.flatnonzero(np.ravel(motion.regular) & np.isfinite(fast) & (fast <= 4.0 * np.nanmedian(fast) + 1e-9))
    return good[(np.array([0.05, 0.3, 0.7, 0.9]) * (len(good) - 1)).astype(int)]


def held_against_mujoco(shown: PosedMechanism) -> None:
    """Compare joints, loops, places and velocities at some poses of a motion."""
    run, motion = MujocoModel(shown), shown.motion
    assert motion is not None
    size, qpos, rates = motion.size * run.length, run.qpos(motion), run.rates(motion)
    places, velocities = (
        np.array([np.broadcast_to(getattr(motion.points[letter], which), motion.shape) for letter, _ in run.sites])
        for which in ("position", "velocity")
    )
    for k in good_poses(motion):
        run.place(qpos[k])
        assert run.gap < 1e-12 * max(size, 1.0)
        assert np.abs(run.places - places[:, k] * run.length).max() < 1e-12 * size
        found, known = run.velocities(run.speeds(rates[k])) / run.length, velocities[:, k]
        assert np.abs(found - known).max() <= 1e-9 * np.abs(known).max()


def test_the_catalog_moves_the_same() -> None:
    for name in ck.exchange.shipped():
        if name not in REFUSED:
            held_against_mujoco(shown(name))


def test_what_no_model_can_say_is_refused() -> None:
    for name in ("five-bar-led", "flat-faced-follower", "oscillating-roller-follower"):
        with pytest.raises(InvalidInput, match="cannot be said in MJCF"):
            FORMAT.write(shown(name))


def same_efforts(motion: Motion) -> MujocoModel:
    """Compare efforts of drivers at all poses of a motion."""
    forces = ck.force_analysis(motion)
    at = {name: float(np.ravel(motion.drives[name].value)[0]) for name in motion.drives}
    run = MujocoModel(posed_mechanism(motion.mechanism, at))
    qpos, rates, accelerations = run.qpos(motion), run.rates(motion), run.rates(motion, "second")
    for k in range(motion.shape[-1]):
        found = run.efforts(qpos[k], rates[k], accelerations[k])
        known = run.signs * [forces.drives[one].effort[k] for one in motion.drives] * run.effort_units
        assert np.abs(found - known).max() <= 1e-8 * np.abs(known).max()
    return run


@pytest.mark.parametrize("name", LOADED)
def test_drivers_take_the_same_efforts(name: str) -> None:
    """With random masses and gravity, at poses with speeds and accelerations."""
    same_efforts(some_poses(heavy(name))[0])


def loaded_slider_crank() -> ck.Mechanism:
    """Forces in axes of the frame and of a link, torques, efforts, springs, dampers, in units of their own."""
    return ck.Mechanism(
        "loaded",
        ck.link("frame", O=(0, 0), S=(30, 60)),
        ck.link("crank", O=(0, 0), A=(40, 0)),
        ck.link("rod", A=(0, 0), B=(100, 0), G=(50, 20)),
        ck.link("piston", B=(0, 0)),
        ck.slide("piston", on="frame", at="B", through="O", name="stroke"),
        ck.drive("crank", values=np.deg2rad([10, 75, 160, 250]), speed=-8.0, acceleration=30.0),
        *(ck.mass(name, mass, inertia=1000 * mass) for name, mass in (("crank", 300), ("rod", 500), ("piston", 400))),
        ck.gravity(1, -9.81),
        ck.force("rod", (30, -50), at="G"),
        ck.force("rod", (-20, 10), at=(20, 5), fixed_in="rod", name="thrust"),
        ck.torque("crank", 700),
        ck.effort("stroke", -350),
        ck.effort("A", 90, name="motor"),
        ck.spring("rod", "G", at="S", stiffness=0.8, free_length=20, preload=3),
        ck.spring(pair="stroke", stiffness=2, free=60, preload=20),
        ck.spring(pair="O", stiffness=500, free=0.3, name="torsion"),
        ck.damper("rod", (30, 0), at=(90, 30), rate=0.02),
        ck.damper(pair="A", rate=3.0, name="bearing"),
        ck.force("piston", lambda t: (0 * t, 5 + 0 * t), at="B", name="pulse"),
        units={"length": "mm", "mass": "g", "force": "mN"},
    )


def test_loads_act_the_same() -> None:
    whole = loaded_slider_crank()
    said = ck.Mechanism(
        "said", *(item for item in whole.items if getattr(item, "name", "") != "pulse"), units=whole.units
    )
    run = same_efforts(ck.solve(said, order=2))
    assert not any("left out" in note for note in run.exported.notes)
    assert "loads that no model says are left out: pulse" in FORMAT.write(posed_mechanism(whole)).notes


@pytest.mark.parametrize("name", ["andrews-squeezer-dynamics", "scissor-lift-loaded", "planetary-train-torques"])
def test_loaded_mechanisms_of_the_catalog(name: str) -> None:
    """A spring and a torque; forces; torques on gears."""
    motion = shown(name).motion
    assert motion is not None
    values = {k: np.broadcast_to(own.value, motion.shape)[good_poses(motion)] for k, own in motion.drives.items()}
    same_efforts(ck.solve(motion.mechanism, values, order=2))


def test_the_four_bar_that_mujoco_computed() -> None:
    """The sample's numbers, once by our forces and once by the model that is written here."""
    sample = entry("mujoco_four_bar")
    four_bar = ck.Mechanism(
        "four-bar",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=(0, 0), B=(1, 0)),
        ck.link("coupler", B=(0, 0), C=(3, 0), P=(1.5, 1)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank", speed=2.0),
        ck.mass("crank", 1, at=(0.5, 0), inertia=0.09),
        ck.mass("coupler", 2, at=(1.5, 0.4), inertia=1.6),
        ck.mass("rocker", 2, at=(1.5, 0), inertia=1.5),
        ck.gravity(0, -9.81),
        units=SI,
    )
    rows = sample["expected"]["rows"]
    motion = ck.solve(four_bar, {"crank": np.deg2rad([row["crank_deg"] for row in rows])})
    torques = ck.force_analysis(motion).drives["crank"].effort
    run = MujocoModel(posed_mechanism(four_bar, {"crank": 1.0}))
    qpos, one = run.qpos(motion), [name for name, _ in run.sites].index("P")
    for k, row in enumerate(rows):
        effort = run.efforts(qpos[k], np.array([2.0]), np.array([0.0]))[0]
        velocity = run.velocities(run.data.qvel)[one]
        for found, known in (
            (torques[k], row["crank_torque"]),
            (effort, row["crank_torque"]),
            (run.places[one], complex(*row["P"])),
            (velocity, complex(*row["P_velocity"])),
        ):
            assert abs(found - known) < sample["tolerance"]


def wheel_led_by_a_plate() -> ck.Mechanism:
    """No pin in a loop: a plate slides, a wheel's middle is in a slot of it and rolls on the ground."""
    return ck.Mechanism(
        "plate",
        ck.link("frame", Q=(0, 0), G=(0, 4)),
        ck.link("plate", P=(0, 0)),
        ck.link("wheel", C=(0, 0), E=(1, 0)),
        ck.slide("plate", on="frame", at="P", through="G", angle=0.3),
        ck.slot("wheel", on="plate", at="C", through="P", angle=1.0),
        ck.roll("wheel", on="frame", at="C", through="Q", radius=2),
        ck.drive("plate", values=np.linspace(0, 30, 31), speed=2.0),
        ck.drawn(P=(0, 4), C=(-1.2, 2), E=(-0.2, 2), Q=(0, 0), G=(0, 4)),
        unit="cm",
    )


def wheel_in_a_ring() -> ck.Mechanism:
    return ck.Mechanism(
        "ring & <wheel>",
        ck.link("frame", O=(0, 0)),
        ck.link("arm", O=(0, 0), C=(2, 0)),
        ck.link('"wheel"', C=(0, 0), E=(1, 0)),
        ck.roll_around('"wheel"', on="frame", at="C", centre_at="O", circle=3, radius=1, inside=True),
        ck.drive("arm", values=np.linspace(0, 15, 61)),
        ck.drawn(O=0, C=(2, 0), E=(3, 0)),
    )


def bar_in_slot_and_arc() -> ck.Mechanism:
    """A slot and an arc in one loop with a driver: one of them is closed by half a link."""
    places = {"O": 0j, "Q": 8 + 0j, "Z": 4 - 3j, "A": 1 + 2j, "B": 5 + 2j, "C": 4 + 5j, "R": 9 + 4j, "S": 0.5 + 1j}
    carried = {"frame": "OQZR", "crank": "OS", "bar": "ABC", "rocker": "CR"}
    return ck.Mechanism(
        "bar",
        *(ck.link(name, *letters) for name, letters in carried.items()),
        ck.slot("bar", on="crank", at="A", through="O", toward="S"),
        ck.arc("bar", on="frame", at="B", centre_at="Z", radius=abs(places["B"] - places["Z"])),
        ck.drive("crank", values=np.linspace(1.0, 1.3, 13)),
        ck.drawn(**places),
    )


SPECIAL = {"plate": (wheel_led_by_a_plate, 1), "ring": (wheel_in_a_ring, 0), "bar": (bar_in_slot_and_arc, 1)}


@pytest.mark.parametrize("name", SPECIAL)
def test_what_the_catalog_has_not(name: str) -> None:
    make, halves = SPECIAL[name]
    at = posed_mechanism(make())
    held_against_mujoco(at)
    assert FORMAT.write(at).text.count("<weld ") == halves


@pytest.mark.parametrize("seed", range(8))
def test_random_dyads_move_the_same(seed: int) -> None:
    rng = np.random.default_rng(seed)
    held_against_mujoco(posed_mechanism(random_sketch(rng, rng.choice(KINDS_OF_DYAD, 3)).mechanism()))


@pytest.mark.parametrize("name", ["six-bar", "planetary-train", "whitworth-quick-return", "scissor-lift-loaded"])
def test_models_run(name: str) -> None:
    """From the keyframe on, the actuators hold the speed and the constraints what is joined."""
    run, start = MujocoModel(shown(name)), shown(name)
    mujoco.mj_resetDataKeyframe(run.model, run.data, 0)
    mujoco.mj_step(run.model, run.data, 1500)
    (driver,) = start.values
    turned = start.rates[driver] * run.data.time
    motion = ck.solve(start.mechanism, {driver: np.linspace(start.values[driver], start.values[driver] + turned, 60)})
    assert abs(run.signs[0] * run.data.qpos[run.joints[0]] - turned) < 0.01
    places = np.array([np.ravel(motion.points[letter].position)[-1] for letter, _ in run.sites]) * run.length
    assert np.abs(run.places - places).max() < 0.01 * motion.size * run.length


def test_drivers_and_guides_have_their_ends() -> None:
    """A driver may go where the mechanism is solved, a cylinder as far as its stroke; a crank goes round."""
    boom = ck.Mechanism(
        "boom",
        ck.link("frame", O=(0, 0), C=(100, -50)),
        ck.link("boom", O=(0, 0), D=(150, 20), T=(400, 0)),
        ck.cylinder("boom", "D", to="frame", at="C", stroke=(50, 130)),
        ck.drive("boom cylinder", values=np.linspace(60, 120, 13), speed=-5),
        unit="mm",
    )
    run = MujocoModel(posed_mechanism(boom, {"boom cylinder": 90}))
    assert run.model.joint("boom cylinder").range == pytest.approx([-0.04, 0.04])
    run = MujocoModel(posed_mechanism(boom))
    length = run.shown.values["boom cylinder"]
    assert run.model.actuator_actrange[0] == pytest.approx([(60 - length) / 1000, (120 - length) / 1000])
    assert not MujocoModel(shown("crank-rocker")).model.actuator_actlimited.any()


def test_names_and_units_are_told() -> None:
    """Names that MuJoCo or XML would not take as they are; what is left out, made up, converted."""
    found = FORMAT.write(shown("andrews-squeezer-dynamics"))
    assert found.notes == ("lengths are in m, masses in kg, forces in N, torques in N m",)
    with pytest.raises(InvalidInput, match="world"):
        FORMAT.write(posed_mechanism(crank_called("world")))
    twice = loaded_slider_crank().replace(ck.force("rod", (1, 0), at="G", name="crank"))
    with pytest.raises(InvalidInput, match="crank: two of one name: actuator"):
        FORMAT.write(posed_mechanism(twice))
    assert mujoco.MjModel.from_xml_string(FORMAT.write(posed_mechanism(crank_called('a"<&>'))).text).nbody == 2


@pytest.mark.parametrize("near", [0.0, 0.1])
def test_what_nothing_drives_is_written_as_drawn(near: float) -> None:
    places = {"A": 0j, "D": 4 + 0j, "B": 1j, "C": 3 + 3j}
    bars = ("AB", "BC", "CD")
    links = [ck.link(name, **{k: (0 if k == name[0] else abs(places[name[1]] - places[name[0]])) for k in name})
             for name in bars]  # fmt: skip
    drawing = ck.drawn(**{**places, "C": places["C"] + near})
    four_bar = ck.Mechanism("free", ck.link("frame", A=0, D=4), *links, drawing)
    if near:
        with pytest.raises(InvalidInput, match="open in the drawing"):
            FORMAT.write(posed_mechanism(four_bar))
    else:
        assert MujocoModel(posed_mechanism(four_bar)).gap < 1e-12


def test_masses_below_those_of_mujoco_are_refused() -> None:
    small = crank_called("crank").replace(
        ck.mass("crank", 1e-3), units={"length": "um", "mass": "mg", "force": "uN"}, unit=""
    )
    with pytest.raises(InvalidInput, match=r"an inertia of .* is too small for MuJoCo"):
        FORMAT.write(posed_mechanism(small))


def test_the_range_of_a_driver_is_that_of_the_drawn_pose() -> None:
    """A crank drawn at -145 degrees that is driven from 200 to 230 is drawn at 215."""
    rocker = ck.load("crank-rocker")
    at = posed_mechanism(rocker, {"crank": ck.deg(215)})
    drawing = ck.drawn(**{letter: at.place(links[0], letter) for letter, links in rocker.carriers.items()})
    swung = rocker.replace(drawing, ck.drive("crank", values=ck.deg(np.linspace(200, 230, 31))))
    run = MujocoModel(posed_mechanism(swung))
    assert run.shown.values["crank"] == pytest.approx(ck.deg(215))
    assert run.model.actuator_actrange[0] == pytest.approx(ck.deg(np.array([-15, 15])))


def test_lengths_below_those_of_mujoco_are_refused() -> None:
    with pytest.raises(InvalidInput, match=r"a mechanism of 7e-06 m is too small for MuJoCo"):
        FORMAT.write(posed_mechanism(ck.load("crank-rocker").replace(unit="um")))
    # what is somewhat larger keeps together
    links = {
        "frame": {"A": 0, "D": 11},
        "crank": {"A": 0, "B": 4},
        "rod": {"B": 0, "C": 10},
        "rocker": {"D": 0, "C": 8},
    }
    double = ck.Mechanism("d", *(ck.link(k, **own) for k, own in links.items()), ck.drive("crank"), unit="um")
    run = MujocoModel(posed_mechanism(double))
    mujoco.mj_resetDataKeyframe(run.model, run.data, 0)
    mujoco.mj_step(run.model, run.data, 1000)
    assert np.abs(run.data.efc_pos[run.data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]).max() < 1e-11
    assert run.data.qpos[0] == pytest.approx(run.data.time, rel=1e-3)


def crank_called(name: str) -> ck.Mechanism:
    return ck.Mechanism("m", ck.link("frame", A=0), ck.link(name, A=0, B=1), ck.drive(name))


def test_the_page_on_mujoco_is_true(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[3] / "docs" / "exchange" / "mujoco.md").read_text("utf-8")
    names: dict[str, Any] = {}
    for code, told in re.findall(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", page, re.DOTALL):
        if "import mujoco" not in code or find_spec("mujoco"):
            exec(code, names)
            assert capsys.readouterr().out == told
