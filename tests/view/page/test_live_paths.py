"""Live pages: what the browser computes for other dimensions is what `solve` finds for that mechanism."""

from __future__ import annotations

import json
import warnings
from base64 import b64decode
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.files import load
from compoundkin.kinematics import Motion
from compoundkin.view.page.html_document import asset
from compoundkin.view.page.live.live_data import live_data
from compoundkin.view.report.pose_sample import Sample

SCRIPTS = ("numbers.js", "live/machine.js", "live/follower.js", "live/states.js", "live/path.js")
# Dyads of all kinds, gears, belts, racks, rolling, slots with ends, cylinders, several drivers, a group of class III,
# change points that other lengths take away.
MECHANISMS = (
    "six-bar", "slider-crank-offset", "elliptic-trammel", "scotch-yoke", "oscillating-guide", "geared-five-bar",
    "planetary-train", "rack-driven-double-slider", "rolling-wheel", "geneva-wheel", "five-bar", "oscillating-cylinder",
    "class-iii-six-bar", "parallelogram", "antiparallelogram",
    # profiles: of a roller and flat faces, a groove, two faces on one cam
    "disc-cam-roller-program", "oscillating-roller-follower", "flat-faced-follower", "oscillating-flat-follower",
    "groove-cam-plate", "constant-breadth-yoke",
)  # fmt: skip
DRAGS, POSES = 100, 19
# Drags as they come, one after another: each from where the one before has led, or from the mechanism as it was.
DRAGGED = """(jobs) => JSON.stringify(JSON.parse(jobs).map(({ data, designs, single }) => {
  const path = new window.compoundkin.Path(data), own = path.solved(path.own);
  let near = own;
  const every = [], failed = [], words = [];
  for (const numbers of designs) {
    near = path.solved(Float64Array.from(numbers), single ? own : near);
    for (const { x, y, angle, v, a } of near.links) every.push(x, y, angle, ...v, ...a);
    failed.push([...near.failed]);
    words.push(failed.at(-1).map((_, k) => path.why(near.numbers, near, k)));
  }
  const bytes = new Uint8Array(Float64Array.from(every.flatMap((row) => [...row])).buffer);
  let rows = "";
  for (let k = 0; k < bytes.length; k += 8190) rows += btoa(String.fromCharCode(...bytes.subarray(k, k + 8190)));
  return { failed, words, rows };
}))"""


class Dragged:
    """A mechanism with the dimensions of its page changed at random, again and again."""

    def __init__(self, name: str, every: int = 0) -> None:
        mechanism = load(name)
        whole = ck.solve(mechanism)
        every = every or max(1, (whole.inputs.poses - 1) // (POSES - 1))
        self.values = {drive: np.ravel(whole.drives[drive].value)[::every] for drive in whole.drives}
        self.rates = {drive: float(np.ravel(whole.drives[drive].rate)[0]) for drive in whole.drives}
        self.motion = ck.solve(mechanism, self.values, speed=self.rates, order=2)
        self.links = tuple(name for name in self.motion.links if name not in mechanism.auxiliary_links)
        poses = self.motion.inputs.poses
        live = live_data(Sample(self.motion), np.arange(poses), self.links, ())
        self.data: dict[str, Any] = {"poses": poses, "start": 0, "live": live}
        self.dimensions = self.data["live"]["dimensions"]
        self.radii = np.array([one["word"] == "radius" for one in self.dimensions])
        self.own = np.array([one["value"] for one in self.dimensions])
        kinds = [one["kind"] for one in self.dimensions]
        units = {"angle": 1.0, "length": self.motion.size, "point": self.motion.size}
        self.scale = np.array([units.get(kind, v) for kind, v in zip(kinds, self.own, strict=True)])
        self.designs = np.array([*self._walk()])

    def _walk(self) -> Iterator[Number]:
        """Steps of two dimensions at a time; every fourth goes halfway back."""
        rng, own, scale = np.random.default_rng(7), self.own, self.scale
        at = own.copy()
        for k in range(DRAGS):
            at = own + (at - own) / 2.0 if k % 4 == 3 else at.copy()
            some = rng.choice(len(own), 2, replace=False)
            at[some] += 0.03 * scale[some] * rng.standard_normal(2)
            # a page takes no negative radius
            yield np.where(self.radii, np.abs(at), at)

    def leaps(self) -> Number:
        """Changes of one dimension by up to 60 % of the size, each of the mechanism as it was."""
        rng = np.random.default_rng(11)
        leap = np.where(np.arange(len(self.own)) == rng.integers(len(self.own), size=(DRAGS, 1)), 0.6 * self.scale, 0.0)
        found = self.own + leap * rng.choice([-1.0, 1.0], (DRAGS, 1)) * rng.uniform(0.3, 1.0, (DRAGS, 1))
        return np.where(self.radii, np.abs(found), found)

    def solved(self) -> Motion:
        """The same designs as `solve` finds them."""
        names = [one["name"] for one in self.dimensions]
        path = ck.compile(self.motion.mechanism, next(iter(self.motion.drives)), free=names, values=self.values)
        changed = dict(zip(names, self.designs.T[:, :, None], strict=True))
        return ck.solve(path.mechanism(changed), self.values, speed=self.rates, order=2, modes=path.modes)


def expected(motion: Motion, links: tuple[str, ...]) -> Number:
    """The same rows of the same links of a motion."""
    rows = []
    for name in links:
        link = motion.links[name]
        for k, turned in enumerate((link.angle, link.angular_velocity, link.angular_acceleration)):
            z = link.origin.derivative(k)
            rows += [np.broadcast_to(row, motion.shape) for row in (z.real, z.imag, turned)]
    return np.stack(rows, axis=1)


def with_paths(browser: Any) -> Any:
    """An empty page that knows paths."""
    view = browser.new_page()
    for name in SCRIPTS:
        view.add_script_tag(content=asset(name))
    return view


@pytest.fixture(scope="module")
def found(browser: Any) -> dict[str, tuple[Dragged, dict[str, Any]]]:
    """What a browser finds for all drags of all mechanisms."""
    dragged = {name: Dragged(name) for name in MECHANISMS}
    view = with_paths(browser)
    jobs = [{"data": one.data, "designs": one.designs.tolist()} for one in dragged.values()]
    found = json.loads(view.evaluate(DRAGGED, json.dumps(jobs)))
    view.close()
    return {name: (one, each) for (name, one), each in zip(dragged.items(), found, strict=True)}


@pytest.mark.parametrize("name", MECHANISMS)
def test_the_browser_finds_what_solve_finds(name: str, found: dict[str, Any]) -> None:
    dragged, told = found[name]
    with warnings.catch_warnings(action="ignore"):
        motion = dragged.solved()
    failed, size = np.array(told["failed"]), motion.size
    rows = np.frombuffer(b64decode(told["rows"])).reshape(DRAGS, -1, failed.shape[1])
    assert np.array_equal(failed, motion.failed)
    rest = rows - expected(motion, dragged.links)
    assert np.array_equal(np.isnan(rest).any(axis=1), failed != 0)
    known = np.where((failed != 0)[:, None], 0.0, rest).reshape(DRAGS, -1, 3, 3, failed.shape[1])
    lengths, angles = np.abs(known[:, :, 0, :2]) / size, known[:, :, 0, 2]
    # full turns may be counted from another one at the first pose, and are the same along the motion
    turns = 2.0 * np.pi * np.rint(angles[..., :1] / (2.0 * np.pi))
    assert max(lengths.max(), np.abs(angles - turns).max()) < 1e-9
    rates = np.abs(known[:, :, 1:]) / (np.array([size, size, 1.0])[:, None] * (1.0 + max(dragged.rates.values())) ** 2)
    # beside limit positions rates have few digits
    assert np.quantile(rates, 0.99) < 1e-9
    with warnings.catch_warnings(action="ignore"):
        gaps = ck.gaps(motion)
    for gap in gaps:
        said = told["words"][gap.design[0]][(gap.first + gap.last) // 2]
        assert said["group"] == (gap.pair or f"{gap.group}({', '.join(gap.links)})")
        # whether a group without a closed form comes back after a gap is found out by `gaps` alone
        assert gap.reason == said["text"] or gap.reason.startswith(f"{said['text']}; ")


def test_a_contact_is_found_as_solve_finds_it_however_far_a_dimension_leaps(browser: Any) -> None:
    names = ("oscillating-roller-follower", "oscillating-flat-follower", "groove-cam-plate")
    view, dragged = with_paths(browser), [Dragged(name) for name in names]
    for one in dragged:
        one.designs = one.leaps()
    jobs = [{"data": one.data, "designs": one.designs.tolist(), "single": True} for one in dragged]
    for one, told in zip(dragged, json.loads(view.evaluate(DRAGGED, json.dumps(jobs))), strict=True):
        with warnings.catch_warnings(action="ignore"):
            motion = one.solved()
        assert np.array_equal(np.array(told["failed"]), motion.failed)
        rows = np.frombuffer(b64decode(told["rows"])).reshape(DRAGS, -1, 3, 3, motion.failed.shape[1])
        rest = rows - expected(motion, one.links).reshape(rows.shape)
        assert np.nanmax(np.abs(rest[:, :, 0, :2])) < 1e-9 * motion.size
        turned = rest[:, :, 0, 2]
        assert np.nanmax(np.abs(turned - 2.0 * np.pi * np.rint(turned / (2.0 * np.pi)))) < 1e-9
    view.close()


def test_change_points_stay_while_nothing_changes_that_they_hang_on(browser: Any) -> None:
    """Points that are only followed are moved: the parallelograms unfold and fold as before."""
    dragged = Dragged("parallelogram-third-crank")
    assert [one["name"] for one in dragged.dimensions if one["keeps"]] == ["coupler.P.x", "coupler.P.y"]
    dragged.designs = dragged.designs[:5]
    job = {"data": dragged.data, "designs": dragged.designs.tolist()}
    view = with_paths(browser)
    told = json.loads(view.evaluate(DRAGGED, json.dumps([job])))[0]
    view.close()
    rows = np.frombuffer(b64decode(told["rows"])).reshape(5, -1, 3, 3, dragged.data["poses"])
    rest = rows - expected(dragged.solved(), dragged.links).reshape(rows.shape)
    assert not np.any(told["failed"])
    assert np.abs(rest[:, :, 0]).max() < 1e-9 * dragged.motion.size
    # the program has no rates where links are in line, at 0, 180 and 360 degrees
    bare = np.isnan(rest).any(axis=(0, 1, 2, 3))
    assert np.allclose(np.sin(dragged.values["crank"][bare]), 0.0, atol=1e-9)
    assert np.nanmax(np.abs(rest)) < 1e-9 * dragged.motion.size


def live(motion: Motion) -> dict[str, Any]:
    """What a page of all poses of a motion has."""
    poses = motion.inputs.poses
    found = live_data(Sample(motion), np.arange(poses), tuple(motion.links), ())
    return {"poses": poses, "start": 0, "live": found}


@pytest.mark.full
def test_updates_keep_up_with_the_hand(browser: Any) -> None:
    six_bar = ck.solve(load("six-bar"), {"crank": ck.deg(range(361))}, order=2)
    large = ck.chains.random_mechanism(groups=20, seed=1)
    drawn = float(np.ravel(ck.solve(large).drives[large.drives[0].name].value)[0])
    many = ck.solve(large, {large.drives[0].name: drawn + np.linspace(0.0, 1e-6, 238)}, order=2)
    view = with_paths(browser)
    for motion, most in ((six_bar, 16.0), (many, 33.0)):
        times = view.evaluate(UPDATES, live(motion))
        # the machine has other work too, of which half of the updates know nothing
        assert np.median(times) < most, motion
    view.close()


UPDATES = """(data) => {
  const path = new window.compoundkin.Path(data), times = [];
  for (let k = 0; k < 50; k++) {
    const numbers = path.own.map((value, n) => value * (1 + 1e-5 * Math.sin(k + n)));
    const from = performance.now();
    path.solved(numbers);
    times.push(performance.now() - from);
  }
  return times;
}"""


def test_a_page_that_cannot_be_live_says_why() -> None:
    for name, why in (
        ("dixon-mechanism", "it is overconstrained"),
        ("conjugate-cams", "it is overconstrained"),
    ):
        assert why in live(ck.solve(load(name)))["live"]["why"]
    assert live(ck.solve(load("six-bar"), {"crank": [0.5]}))["live"] is None


def test_dimensions_are_those_that_may_be_changed_alone() -> None:
    def names(name: str) -> set[str]:
        return {one["name"] for one in live(ck.solve(load(name)))["live"]["dimensions"]}

    # the arm of wheels with a module is as long as these ask, their teeth are whole
    assert {"sun.S.x", "planet.Q.y"} < names("planetary-train")
    assert not {one for one in names("planetary-train") if "teeth" in one or one.startswith("arm.")}
    # an overconstrained lift moves by its equal arms alone
    assert names("double-parallelogram-lift") == {"head.T.x", "head.T.y"}
    assert {"slot.angle", "crank.D.x", "frame.B.y"} < names("six-bar")


BADGES = """(designs) => designs.map((numbers) => {
  const [player] = compoundkin.players, { design } = player;
  design.change(Object.fromEntries(design.names.map((name, k) => [name, numbers[k]])));
  const shown = [...document.querySelectorAll(".badges > [data-badge]")];
  return [
    shown.map((one) => [one.dataset.badge, one.textContent.trim(), one.classList.contains("stale")]),
    document.querySelectorAll("section[data-depends]:not([data-follows], .folded)").length,
    document.querySelector(".changes .words").textContent,
  ];
})"""


@pytest.mark.parametrize("name", ["six-bar", pytest.param("geared-five-bar", marks=pytest.mark.full)])
def test_badges_tell_what_solve_counts_after_every_change(name: str, made: Any, opened: Any) -> None:
    """The count of poses follows a hundred changes; checks and published numbers of other dimensions are struck out."""
    dragged = Dragged(name, every=1)
    dragged.designs = dragged.own + 4.0 * (dragged.designs - dragged.own)  # so far that many do not assemble everywhere
    with warnings.catch_warnings(action="ignore"):
        failed = dragged.solved().failed != 0
    view = opened(made(name))
    told = view.value(BADGES, dragged.designs.tolist())
    counts = (~failed).sum(axis=1)
    assert len(set(counts)) > 5  # some assemble everywhere, others do not
    for (badges, open_sections, words), count in zip(told, counts, strict=True):
        (first, text, stale), *rest = badges
        mark = "✓" if count == failed.shape[1] else "✗"
        assert (first, text, stale) == ("assembled", f"{mark} {count} of {failed.shape[1]} poses assembled", False)
        assert rest
        assert all(one[2] for one in rest)
        assert open_sections == 0
        assert ("cannot be assembled" in words) == (count < failed.shape[1])
    view.value("() => compoundkin.players[0].design.reset()")
    ((badges, _, _),) = view.value(BADGES, [dragged.own.tolist()])
    assert not any(stale for *_, stale in badges)
    assert view.complaints == []
