"""Frames, and GIF and MP4 made of them."""

from __future__ import annotations

import io
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.animation import films as gif_module
from compoundkin.view.animation import films as mp4_module
from compoundkin.view.animation.films import APART, colour_palette, indices, nearest_table
from compoundkin.view.sketch.shapes import ArcShape, CircleShape, Text, leaves
from compoundkin.view.sketch.sketch_style import NUMBER
from compoundkin.view.sketch.svg import pixel_size, pixels
from tests import catalog

pytest.importorskip("cairosvg")
Image = pytest.importorskip("PIL.Image")
needs_ffmpeg = pytest.mark.skipif(
    shutil.which("ffmpeg") is None or shutil.which("ffprobe") is None, reason="ffmpeg and ffprobe are not installed"
)


def six_bar(poses: int = 13) -> ck.results.Motion:
    return ck.solve(load("six-bar"), {"crank": ck.deg(np.linspace(0.0, 360.0, poses))})


def small(**more: object) -> ck.results.Animation:
    return six_bar().animate(size=120, seconds=0.6, **more)  # type: ignore[arg-type]


def gif_of(path: Path) -> tuple[list[np.ndarray], list[int], int]:
    """The frames of a GIF, their durations in milliseconds, and how often it is repeated, 0 for ever."""
    with Image.open(path) as image:
        frames, durations = [], []
        for k in range(image.n_frames):
            image.seek(k)
            frames.append(np.asarray(image.convert("RGB")).copy())
            durations.append(image.info["duration"])
        return frames, durations, image.info["loop"]


# --- frames ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["six-bar", "jansen-leg", "geneva-wheel", "hydraulic-digger"])
def test_in_every_frame_pins_are_where_the_points_are(name: str) -> None:
    motion = catalog.motion(name)
    animation = motion.animate(paths=True, vectors="velocity", seconds=1)
    poses = animation.sketch.scene.known[animation.timeline.poses[animation.timeline.frames]]
    for k, pose in enumerate(poses):
        picture = animation.frame(k)
        assert picture.window is not None
        circles = np.array([shape.centre for shape in leaves(picture.shapes) if isinstance(shape, CircleShape)])
        for letter, links in motion.mechanism.carriers.items():
            if len(links) > 1:
                place = picture.window.at(motion.points[letter].position[pose])
                assert np.min(np.abs(circles - place)) < 1e-9 * picture.width


def test_a_frame_is_a_picture_with_the_drivers_value_below(tmp_path: Path) -> None:
    animation = six_bar().animate(paths="G", centres=True)
    frames = [animation.frame(k) for k in range(len(animation))]
    assert {(frame.width, frame.height) for frame in frames} == {(frames[0].width, frames[0].height)}
    texts = [[s.text for s in leaves(frame.shapes) if isinstance(s, Text)] for frame in frames]
    assert [any("crank at 90°" in text for text in some) for some in texts] == [k == 3 for k in range(12)]
    frames[-1].save(tmp_path / "frame.svg")
    assert (tmp_path / "frame.svg").read_text("utf-8") == animation.frame(11).svg == animation.frame(-1).svg
    assert not any("crank" in s.text for s in leaves(small(labels=False).frame(0).shapes) if isinstance(s, Text))


def test_the_time_stands_below_a_motion_in_time() -> None:
    motion = ck.solve(load("crank-rocker"), {"crank": 0.0}, speed=np.pi, time=np.linspace(0.0, 2.0, 201))
    texts = [s.text for s in leaves(motion.animate().frame(25).shapes) if isinstance(s, Text)]
    assert any("at 1.00 s" in text for text in texts)
    assert "time, 0 to 2 s" in motion.animate().svg


def test_arrows_have_one_scale_and_room() -> None:
    motion = six_bar(73)
    animation = motion.animate(vectors="velocity")
    scale = animation.arrows[0].scale
    window = animation.sketch.window
    for letter in ("D", "A", "C", "G"):
        points = motion.points[letter]
        tips = window.at(points.position) + np.conjugate(points.velocity) * scale.per_unit
        assert all(window.holds(complex(tip)) for tip in tips)
    fastest = max(float(np.max(motion.points[letter].speed)) for letter in "DACG")
    assert scale.amount <= fastest < 5.0 * scale.amount
    assert any(scale.text in s.text for s in leaves(animation.frame(0).shapes) if isinstance(s, Text))


def test_forces_have_their_names_and_moments_arcs_in_their_sense() -> None:
    """At every frame: the driver's arc turns as its torque does, and a force's name is ahead of its arrow or beside."""
    forces = ck.force_analysis(ck.solve(load("engine-gas-pressure")))
    animation = ck.animate(forces, seconds=1)
    scale, window, senses = animation.arrows[0].scale, animation.sketch.window, set()
    for k in range(len(animation)):
        pose = int(animation.timeline.poses[animation.timeline.frames[k]])
        shapes = list(leaves(animation.frame(k).shapes))
        torque = float(forces.drives["crank"].effort[pose])
        arcs = [one for one in shapes if isinstance(one, ArcShape) and one.style == "reaction"]
        # none next to the dead points; y points down on paper
        largest = np.abs(forces.drives["crank"].effort).max()
        assert [one.sweep for one in arcs] == [torque < 0.0] * int(abs(torque) >= 0.01 * largest)
        senses.add(torque < 0.0)
        force = complex(forces.pairs["A"].on("rod").force[pose])
        start = complex(window.at(forces.motion.points["A"].position[pose]))
        along = np.linspace(0.5, 1.0, 51) * np.conjugate(force) * scale.per_unit
        names = [one.at for one in shapes if isinstance(one, Text) and one.text == "F₂₃"]
        assert not names or 3.0 < np.min(np.abs(names[0] - start - along)) < 20.0
        assert bool(names) == (abs(force) * scale.per_unit >= 14.0)
    assert senses == {True, False}
    assert "arcs: moments, not to scale" in animation.svg
    assert not [one for one in leaves(ck.animate(forces, labels=False).frame(3).shapes)
                if isinstance(one, Text) and one.text == "F₂₃"]  # fmt: skip


# --- GIF ------------------------------------------------------------------------------------------------


def test_a_gif_has_all_frames_and_goes_on_for_ever(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    animation = small()
    animation.save(tmp_path / "a.gif", lambda done, total: told.append((done, total)))
    frames, durations, loop = gif_of(tmp_path / "a.gif")
    assert (len(frames), loop) == (12, 0)
    assert durations == [50] * 12
    assert told == [(k + 1, 12) for k in range(12)]
    assert all((one != two).any() for one, two in zip(frames, [*frames[1:], frames[0]], strict=True))
    size = pixel_size(animation.frame(0).width, animation.frame(0).height, 120)
    assert frames[0].shape == (size[1], size[0], 3)
    assert max(size) == 120
    for k in (0, 7):
        exact = pixels(animation.frame(k).svg, *size).astype(int)
        assert np.max(np.abs(frames[k] - exact).sum(axis=-1)) <= 2 * APART
        paper = (exact == 255).all(axis=-1)
        assert (frames[k][paper] == 255).all()


def test_durations_add_up_where_a_frame_takes_no_whole_hundredth(tmp_path: Path) -> None:
    six_bar().animate(size=60, seconds=0.41).save(tmp_path / "a.gif")
    frames, durations, _ = gif_of(tmp_path / "a.gif")
    assert len(frames) == len(durations) <= 10
    assert sum(durations) == 410


def test_a_gif_has_no_more_frames_a_second_than_browsers_show() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="at most 50 frames a second"):
        six_bar(121).animate(size=60, seconds=2, fps=60).content("gif")


def test_a_turn_of_the_six_bar_is_well_below_a_megabyte(tmp_path: Path) -> None:
    animation = six_bar(73).animate(size=640, seconds=4)
    some = [pixels(animation.frame(k).svg, *(640, 640)) for k in range(0, 72, 12)]
    whole = gif_module.gif(
        gif_module.FilmFrames(lambda k: some[k], len(some), 0.05, (640, 640)), lambda done, total: None
    )
    assert len(whole) / len(some) * 72 < 850_000


def test_a_palette_keeps_the_colours_that_are_drawn_with() -> None:
    rng = np.random.default_rng(1)
    flat = np.array([[255, 255, 255], [192, 74, 0], [0, 103, 177], [27, 31, 36]])
    drawn = np.concatenate([np.repeat(flat, [500, 60, 50, 40], axis=0), rng.integers(0, 256, (30, 3))])
    colours = colour_palette(drawn.astype(np.uint8), 8)
    assert len(colours) == 8
    assert colours[:4].tolist() == flat.tolist()
    table = nearest_table(colours)
    assert indices(flat.astype(np.uint8), table).tolist() == [0, 1, 2, 3]
    some = rng.integers(0, 256, (200, 3)).astype(np.uint8)
    exact = np.min(np.linalg.norm(some[:, None].astype(float) - colours, axis=-1), axis=1)
    found = np.linalg.norm(some.astype(float) - colours[indices(some, table)], axis=-1)
    # colours are told apart in steps of eight
    assert np.max(found - exact) <= 2.0 * np.linalg.norm([4, 4, 4])


# --- MP4 ------------------------------------------------------------------------------------------------


@needs_ffmpeg
def test_an_mp4_has_all_frames_and_plays_everywhere(tmp_path: Path) -> None:
    animation = small()
    animation.save(tmp_path / "a.mp4")
    words = ["ffprobe", "-v", "error", "-count_frames", "-show_streams", "-show_format", "-of", "json"]
    told = json.loads(subprocess.run([*words, str(tmp_path / "a.mp4")], capture_output=True, check=True).stdout)
    (stream,) = told["streams"]
    width, height = pixel_size(animation.frame(0).width, animation.frame(0).height, 120)
    assert (stream["codec_name"], stream["pix_fmt"]) == ("h264", "yuv420p")
    assert (stream["width"], stream["height"]) == (width, height)
    assert width % 2 == height % 2 == 0
    assert int(stream["nb_read_frames"]) == 12
    assert float(told["format"]["duration"]) == pytest.approx(0.6)
    assert not [tag for tag in told["format"]["tags"] if "time" in tag or "date" in tag]
    content = (tmp_path / "a.mp4").read_bytes()
    assert content.index(b"moov") < content.index(b"mdat")
    assert content == animation.content("mp4")


@needs_ffmpeg
def test_the_frames_of_an_mp4_are_those_drawn(tmp_path: Path) -> None:
    animation = small()
    animation.save(tmp_path / "a.mp4")
    width, height = pixel_size(animation.frame(0).width, animation.frame(0).height, 120)
    words = ["ffmpeg", "-v", "error", "-i", str(tmp_path / "a.mp4"), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(words, capture_output=True, check=True).stdout
    shown = np.frombuffer(raw, dtype=np.uint8).reshape(12, height, width, 3).astype(int)
    for k in (0, 5, 11):
        off = [np.mean(np.abs(shown[k] - pixels(animation.frame(n).svg, width, height))) for n in range(12)]
        assert int(np.argmin(off)) == k
        assert off[k] < 6.0


@needs_ffmpeg
def test_what_ffmpeg_says_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mp4_module, "QUALITY", "worst")
    with pytest.raises(ck.errors.InvalidInput, match=r"ffmpeg failed: .*worst"):
        small().content("mp4")


def test_without_ffmpeg_it_says_what_to_do(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ck.errors.InvalidInput, match=r"needs the program ffmpeg.*\.gif or \.svg"):
        small().save(tmp_path / "a.mp4")
    assert not list(tmp_path.iterdir())


# --- files ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", ["gif", "svg"])
def test_the_same_animation_is_the_same_file(form: str) -> None:
    assert small().content(form) == small().content(form)


def test_what_was_there_stays_if_drawing_fails_halfway(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.gif"
    path.write_bytes(b"old")

    def stopped(done: int, total: int) -> None:
        if done == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        small().save(path, stopped)
    assert path.read_bytes() == b"old"
    assert [file.name for file in tmp_path.iterdir()] == ["a.gif"]


@needs_ffmpeg
def test_no_process_is_left_if_drawing_fails_halfway(tmp_path: Path) -> None:
    def stopped(done: int, total: int) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        small().save(tmp_path / "a.mp4", stopped)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "said"), [("a.avi", "not saved as '.avi'"), ("a", "no suffix"), ("none/a.gif", "no such folder")]
)
def test_a_file_that_cannot_be_is_refused_before_anything_is_drawn(tmp_path: Path, name: str, said: str) -> None:
    told: list[int] = []
    with pytest.raises(ck.errors.InvalidInput, match=said):
        small().save(tmp_path / name, lambda done, total: told.append(done))
    assert not told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("missing", "form"), [("cairosvg", "gif"), ("PIL", "gif"), ("cairosvg", "mp4")])
def test_without_a_library_it_says_what_to_install(
    missing: str, form: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(__import__("sys").modules, missing, None)
    monkeypatch.setattr(shutil, "which", lambda name: name)
    with pytest.raises(ck.errors.InvalidInput, match=r"pip install 'compoundkin\[animation\]'"):
        small().save(tmp_path / f"a.{form}")


def test_notebooks_show_what_moves() -> None:
    assert "<animateTransform" in small()._repr_svg_()
    assert io.StringIO(small()._repr_svg_()).readline().startswith("<svg")


def test_no_label_leaves_the_picture() -> None:
    animation = ck.animate(load("hydraulic-digger"))
    window = animation.sketch.window
    for k in range(0, len(animation), 8):
        badges = [
            s.centre for s in leaves(animation.frame(k).shapes) if isinstance(s, CircleShape) and s.radius == NUMBER
        ]
        assert len(badges) == len(animation.sketch.scene.mechanism.links) - 1
        assert all(window.holds(place, NUMBER) for place in badges)
