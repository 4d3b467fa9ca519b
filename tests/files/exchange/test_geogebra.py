"""GeoGebra: constructions whose commands, evaluated one by one, put every point where solving has it."""

from __future__ import annotations

import io
import warnings
from typing import Any
from xml.etree import ElementTree
from zipfile import ZipFile

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.geogebra.dragged_construction import Construction, ObjectNames
from compoundkin.files.exchange.geogebra.geogebra_format import COMMANDS, construction_of
from compoundkin.files.exchange.geogebra.geogebra_format import FORMAT as FILE
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from tests import catalog
from tests.files.exchange.geogebra_evaluator import Shape, evaluated
from tests.files.exchange.shown_catalog import shown
from tests.support import KINDS_OF_DYAD, random_sketch

# Groups of class III and above; profiles; gears that only together give their angles.
REFUSED = {
    "3-rrr": "class 3", "class-iii-six-bar": "class 3", "stephenson-ii": "class 3",
    "stephenson-ii-driven-at-binary": "class 4", "stephenson-iii-driven-at-dyad": "class 3",
    "stephenson-iii-floating-driver": "class 3", "conjugate-cams": "cam pair", "disc-cam-roller-program": "cam pair",
    "groove-cam-plate": "cam pair", "oscillating-roller-follower": "cam pair",
    "constant-breadth-yoke": "flat-faced cam pair", "flat-faced-follower": "flat-faced cam pair",
    "oscillating-flat-follower": "flat-faced cam pair",
}  # fmt: skip


def shown_of(structure: ck.results.Structure) -> PosedMechanism:
    """A mechanism over its drivers' ranges; where it is shown does not matter here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return PosedMechanism(structure, {}, {}, {}, ck.solve(structure, order=0))


def driven(build: Construction, motion: ck.results.Motion) -> dict[str, Any]:
    """The sliders' values at the poses of a motion."""
    angles, count = motion.structure.driven_angles, motion.failed.size
    rows = {name: np.ravel(drive.value) for name, drive in motion.drives.items()}
    rows = {name: np.repeat(row, count) if row.size == 1 else row for name, row in rows.items()}
    return {build.driven[name]: np.rad2deg(row) if angles[name] else row for name, row in rows.items()}


def farthest(lines: list[str], given: dict[str, Any], motion: ck.results.Motion) -> float:
    """How far a point is from where solving has it, at the worst, in parts of the size."""
    with np.errstate(invalid="ignore"):
        known = evaluated(lines, given)
    names, good = ObjectNames(), np.ravel(motion.assembled)
    gaps = [np.abs(known[names.point(k)] - np.ravel(p.position))[good] for k, p in motion.points.items()]
    return float(np.max(gaps)) / motion.size


def check(mechanism: ck.Mechanism, build: Construction, tolerance: float = 1e-12, **changed: Any) -> None:
    """Hold a construction with some numbers changed against the mechanism that has them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = ck.solve(mechanism, order=0)
    assert np.count_nonzero(motion.assembled) > 20
    names = {step.name for step in build.steps if step.is_free}
    assert set(changed) <= names, f"no such numbers: {set(changed) - names}"
    assert farthest(build.lines, {**driven(build, motion), **changed}, motion) < tolerance


def test_the_catalog_is_constructed() -> None:
    refused = {}
    for name in catalog.NAMES:
        one = shown(name)
        try:
            build = construction_of(one)
        except InvalidInput as error:
            refused[name] = error.problems[0].what
            continue
        assert one.motion is not None
        assert farthest(build.lines, driven(build, one.motion), one.motion) < 1e-12, name
    assert refused.keys() == REFUSED.keys()
    assert all(REFUSED[name] in what for name, what in refused.items())


@pytest.mark.parametrize("seed", range(10))
def test_random_mechanisms_are_constructed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one = shown_of(ck.decompose(random_sketch(rng, rng.choice(KINDS_OF_DYAD, 3)).mechanism()))
    assert one.motion is not None
    assert one.motion.assembled.any()
    build = construction_of(one)
    assert farthest(build.lines, driven(build, one.motion), one.motion) < 1e-7  # guides may be nearly parallel


TIMES = np.linspace(0.0, 6.0, 50)
CRANK = (ck.link("crank", A=0, B=10), ck.drive("crank"))
WHEELS = (
    ck.link("sun", O=0, S=1), ck.link("arm", O=0, P=3), ck.link("planet", P=0, Q=1),
    ck.gear("sun", "planet", carrier="arm", teeth=(20, 20)), ck.drive("sun", values=TIMES),
)  # fmt: skip
WHEEL = ck.link("wheel", P=(0.2, 0.3), Q=(1, 0.5))
# What the catalog has not: gearboxes, arcs, guides toward points and beside them, wheels that roll.
OTHERS = {
    "gearbox": (
        ck.link("frame", O=0), ck.link("ring", O=0, R=5), *WHEELS, ck.drive("ring", values=0.3 * TIMES),
        ck.gear("planet", "ring", carrier="arm", teeth=(20, 60), internal=True),
    ),
    "fixed ring": (
        ck.link("frame", O=0, R=5), *WHEELS,
        ck.gear("planet", "frame", carrier="arm", teeth=(20, 60), internal=True, second_at="O"),
    ),
    "arc": (
        ck.link("frame", A=0, D=(50, 0)), *CRANK, ck.link("rod", B=0, C=45, E=(20, 10)),
        ck.arc("rod", on="frame", at="C", centre_at="D", radius=25), ck.drawn(B=(10, 0), C=(45, 20)),
    ),
    "slot": (
        ck.link("frame", A=0, F=(0, -30)), *CRANK, ck.link("lever", F=0, G=(40, 10), K=(60, 0)),
        ck.slot("crank", on="lever", at="B", through="F", toward="G", offset=2),
    ),
    "ram": (
        ck.link("frame", A=0, H=(10, -60), L=(60, -50)), *CRANK, ck.link("rod", B=0, C=70),
        ck.link("ram", C=0, W=(4, 3)), ck.slide("ram", on="frame", at="W", through="H", toward="L", offset=3, turn=0.3),
    ),
    "belt": (
        ck.link("frame", A=0, D=(50, 0)), *CRANK, ck.link("wheel", D=0, E=12),
        ck.belt("wheel", "crank", radii=(5, 9), crossed=True, phase=0.4),
    ),
    "in a ring": (
        ck.link("frame", O=0), WHEEL, ck.drive("wheel"),
        ck.roll_around("wheel", on="frame", centre_at="O", at="P", circle=4, radius=1.5, inside=True),
    ),
    "on a disc": (
        ck.link("frame", O=(1, 1)), WHEEL, ck.drive("wheel"),
        ck.roll_around("wheel", on="frame", centre_at="O", at="P", circle=4, radius=1.5, phase=0.3),
    ),
    "on a road": (
        ck.link("frame", O=(1, 2)), WHEEL, ck.drive("wheel", values=2.0 * TIMES),
        ck.roll("wheel", on="frame", through="O", at="P", radius=2, side=-1, angle=0.3),
    ),
    "names": (
        ck.link("frame", **{"x": 0, "\u00e9": (5.5, 0)}), ck.link("\u8fde", **{"x": 0, "tip 1": 2}),
        ck.link("e", **{"tip 1": 0, "C": 5}), ck.link("</a>", **{"\u00e9": 0, "C": 4}), ck.drive("\u8fde"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_what_the_catalog_has_not_is_constructed(name: str) -> None:
    mechanism = ck.Mechanism(name, *OTHERS[name])
    check(mechanism, construction_of(shown_of(ck.decompose(mechanism))))
    ElementTree.fromstring(ZipFile(io.BytesIO(FILE.write(posed_mechanism(mechanism)).content)).read("geogebra.xml"))


def test_a_number_is_changed() -> None:
    """Each number that a teacher may change is that of the mechanism."""
    six_bar = catalog.mechanism("six-bar")
    build = construction_of(shown("six-bar"))
    plate = ck.link("plate", D=0, A=41, C=ck.polar(17, ck.deg(25)))
    check(six_bar.replace(plate), build, **{"l_{DA}": 41.0, "l_{DC}": 17.0, "α_{DC}": 25.0})
    moved = six_bar.replace(ck.link("frame", E=0, B=(42, 2), F=(1, -33)))
    check(moved, build, B=np.complex128(42 + 2j), F=np.complex128(1 - 33j))
    check(six_bar.replace(ck.mode(-1, "plate", "rocker"), ck.mode(1, "bar")), build, m_A=-1.0)


def test_numbers_of_pairs_are_changed() -> None:
    offset = catalog.mechanism("slider-crank-offset")
    guide = next(pair for pair in offset.written_pairs if pair.table == "slides")
    words = {key: getattr(guide, key) for key in ("link", "on", "at", "through", "name", "turn")}
    build = construction_of(posed_mechanism(offset.replace(ck.slide(**words, angle=ck.deg(5), offset=0.1))))
    names = {step.name[0]: step.name for step in build.steps if guide.name in step.caption}
    changed = offset.replace(ck.slide(**words, angle=ck.deg(-10), offset=-0.2))
    check(changed, build, **{names["β"]: -10.0, names["e"]: -0.2})
    five = catalog.mechanism("geared-five-bar-symmetrical")
    gear = ck.gear("crank", "wheel", teeth=(20, 10), phase=1.0, name=five.written_pairs[0].name)
    geared = construction_of(shown("geared-five-bar-symmetrical"))
    phase = next(step.name for step in geared.steps if step.caption.startswith("where the first"))
    check(five.replace(gear), geared, **{"z_{crank}": 20.0, "z_{wheel}": 10.0, phase: np.rad2deg(1.0)})


def test_a_mode_is_a_number() -> None:
    """The sign of a group is a number by its inner pin, whatever chose it."""
    four_bar = catalog.mechanism("four-bar-norton")
    build = construction_of(shown("four-bar-norton"))
    (mode,) = [step for step in build.steps if step.name.startswith("m_")]
    other = four_bar.replace(ck.mode(int(-mode.numbers[0]), "coupler"))
    check(other, build, **{mode.name: -mode.numbers[0]})


def test_a_parallelogram_stays_one() -> None:
    """Past the places where its links are in line, in the other mode of its dyad; and one says so."""
    one = shown("parallelogram")
    exported = COMMANDS.write(one)
    assert "m_C = If(φ_{crank} < 180, -1, 1)" in exported.text
    assert exported.notes[0].startswith("m_C changes where the links are in line")
    known = evaluated(exported.text.splitlines(), {"φ_{crank}": np.arange(0.5, 360.0)})
    np.testing.assert_allclose(known["C"] - known["B"], known["D"] - known["A"], atol=1e-9)


def test_the_file_holds_the_commands() -> None:
    """Its XML, read back, says the lines of the list; and it is the same bytes each time."""
    for name in ("six-bar", "excavator-arm", "geared-coupler", "parallelogram"):
        content = FILE.write(shown(name)).content
        assert content == FILE.write(shown(name)).content
        with ZipFile(io.BytesIO(content)) as archive:
            assert archive.namelist() == ["geogebra.xml"]
            root = ElementTree.fromstring(archive.read("geogebra.xml"))
        assert root.tag == "geogebra"
        lines = COMMANDS.write(shown(name)).text.splitlines()
        assert [*_lines(root.find("construction"))] == lines
        objects = {e.get("label"): e for e in root.iter("element")}
        for label, found in evaluated(lines, {}).items():
            kind = objects[label].get("type")
            assert kind == (found.kind if isinstance(found, Shape) else kind).replace("circle", "conic")
            assert (kind in ("point", "vector")) == np.iscomplexobj(found)


def _lines(construction: Any) -> Any:
    """The input-bar commands that an XML stands for."""
    waiting = ""
    for node in construction:
        if node.tag == "expression":
            waiting = f"{node.get('label')} = {node.get('exp')}"
        elif node.tag == "command":
            given = ", ".join(node.find("input").attrib.values())
            waiting = f"{node.find('output').get('a0')} = {node.get('name')}({given})"
        else:
            yield from [waiting] if waiting else _free(node)
            waiting = ""


def _free(element: Any) -> Any:
    label, slider, place = element.get("label"), element.find("slider"), element.find("coords")
    if place is not None:
        yield f"{label} = ({place.get('x')}, {place.get('y')})"
        return
    value = element.find("value").get("val")
    if slider is None:
        yield f"{label} = {value}"
        return
    yield f"{label} = Slider({slider.get('min')}, {slider.get('max')}, {element.find('animation').get('step')})"
    if value != slider.get("min"):
        yield f"SetValue({label}, {value})"


def test_the_pose_asked_for_is_shown() -> None:
    mechanism = catalog.mechanism("six-bar")
    lines = COMMANDS.write(posed_mechanism(mechanism, {"crank": ck.deg(35)})).text.splitlines()
    assert lines[:2] == ["φ_{crank} = Slider(0, 360, 1)", "SetValue(φ_{crank}, 35)"]
    # the published position at 35 degrees
    assert abs(evaluated(lines, {})["G"] - (31.639333709086156 + 10.988360299582874j)) < 1e-12


def test_sliders_begin_at_the_drawn_pose_by_whole_turns() -> None:
    rocker = catalog.mechanism("crank-rocker")
    at = posed_mechanism(rocker, {"crank": ck.deg(-145)})
    drawn = ck.drawn(**{letter: at.place(links[0], letter) for letter, links in rocker.carriers.items()})
    for seen in (at, posed_mechanism(rocker.replace(drawn)), posed_mechanism(rocker, {"crank": ck.deg(215 + 360)})):
        found = COMMANDS.write(seen)
        begun = float(found.text.splitlines()[1].removeprefix("SetValue(φ_{crank}, ").removesuffix(")"))
        assert begun == pytest.approx(215.0)
        assert not found.notes
        assert abs(evaluated(found.text.splitlines(), {})["C"] - at.place("coupler", "C")) < 1e-9
    # a wheel that turns with the crank is elsewhere after a turn of it
    geared = ck.Mechanism(
        "Gears", ck.link("frame", A=0, B=5), ck.link("crank", A=0), ck.link("wheel", B=0, C=1), ck.drive("crank"),
        ck.gear("crank", "wheel", teeth=(20, 30), carrier="frame"),
    )  # fmt: skip
    (note,) = COMMANDS.write(posed_mechanism(geared, {"crank": ck.deg(420)})).notes
    assert note.startswith("crank begins at the end of its range")
    fixed = rocker.replace(ck.drive("crank", values=[1.0]))
    assert COMMANDS.write(posed_mechanism(fixed, {"crank": ck.deg(90)})).text.startswith("φ_{crank} = 90")


def test_all_that_cannot_be_constructed_is_told_at_once() -> None:
    class_iii = catalog.mechanism("class-iii-six-bar")
    frame = ck.link("frame", **{**class_iii.links["frame"].points, "Z": (100, 100)})
    oval = ck.profiles.profile([(30, 0), (0, 40), (-50, 0), (0, -30)], closed=True)
    cam = ck.cam("follower", on="disc", at="R", profile=oval, radius=5)
    guide = ck.slide("follower", on="frame", at="R", through="Z", angle=ck.deg(90))
    more = [ck.link("disc", Z=0), ck.link("follower", R=0), ck.drive("disc"), cam, guide]
    mechanism = class_iii.replace(frame, *more)
    with pytest.raises(InvalidInput) as told:
        COMMANDS.write(posed_mechanism(mechanism))
    assert len(told.value.problems) == 2
    assert all("positions" in problem.remedy for problem in told.value.problems)
