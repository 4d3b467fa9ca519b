"""The figures of the pages, drawn by the program itself. Run `python -m tests.figures` to write them."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.files import load
from compoundkin.view.sketch.kinematic_sketch import ghost_shapes, layered, window_on
from compoundkin.view.sketch.labels import label_shapes, placed, point_letters
from compoundkin.view.sketch.painter import Painter
from compoundkin.view.sketch.picture_options import scene_of
from compoundkin.view.sketch.scene import fitted_window
from compoundkin.view.sketch.shapes import Polygon, Polyline

DOCS = Path(__file__).parents[1] / "docs"
FOLDER = DOCS / "figures"
SIX_BAR, AT = load("six-bar"), ck.deg(35)


def made_on(page: str, name: str = "picture") -> ck.results.Picture:
    """What a page makes under a name: its code, run here."""
    code = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, Any] = {}
    with TemporaryDirectory() as folder, contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()):
        exec("".join(code), names)
    found: ck.results.Picture = names[name]
    return found


def six_bar() -> ck.results.Picture:
    """The six-bar at 35 degrees, with the path of G."""
    return ck.draw(SIX_BAR, AT, paths="G")


def posed() -> ck.results.Motion:
    """The six-bar at that pose alone."""
    return ck.solve(SIX_BAR, {"crank": [AT]})


def modes() -> ck.results.Picture:
    """A four-bar in both assembly modes of its dyad, the second one faint."""
    mechanism, values = load("crank-rocker"), {"crank": [ck.deg(60)]}
    return with_ghosts(*(ck.solve(mechanism, values, modes={"rocker": sign}) for sign in (1, -1)))


def limit() -> ck.results.Picture:
    """A triple rocker at a limit position, where its two modes meet; faint both modes before it."""
    mechanism = load("triple-rocker")
    (greatest,) = {limit.value for limit in ck.circuits(mechanism).limits if limit.greatest and limit.value > 0}
    at_limit = ck.solve(mechanism, {"driver": [greatest]})
    before = [ck.solve(mechanism, {"driver": [ck.deg(70)]}, modes={"rocker": sign}) for sign in (1, -1)]
    return with_ghosts(at_limit, *before)


def transmission() -> ck.results.Picture:
    """A crank-rocker with its crank on the line of the frame: least transmission angle, and faintly the other end."""
    mechanism = load("crank-rocker")
    return with_ghosts(*(ck.solve(mechanism, {"crank": [ck.deg(at)]}) for at in (0, 180)))


def workspace() -> ck.results.Picture:
    """The region that the tip of a five-bar reaches in the drawn mode, around the robot, and the lens of all modes."""
    robot = load("five-bar")
    motion = ck.solve(robot, {"left": [ck.deg(100)], "right": [ck.deg(75)]})
    outlines = [ck.figures.workspace(robot, "P", modes=modes, cells=160).outer[0] for modes in (None, "all")]
    scene = scene_of(motion, None, None, 0)
    window = window_on(scene)
    window = fitted_window(window, np.concatenate([window.at(outline) for outline in outlines]))
    painter = Painter(scene, window)
    sketch = layered(painter)
    names = label_shapes(scene, placed(point_letters(painter), sketch, window.width, window.height))
    wide, high = complex(window.width), complex(0.0, window.height)
    region, lens = (tuple(complex(z) for z in window.line(outline)) for outline in outlines)
    shapes = Polygon((0j, wide, wide + high, high), "paper"), Polyline(lens, "ray"), Polyline(region, "path")
    return ck.results.Picture((*shapes, *sketch, *names), window.width, window.height, robot.title, window=window)


def with_ghosts(motion: ck.results.Motion, *others: ck.results.Motion) -> ck.results.Picture:
    """The sketch of a motion of one pose, others drawn faintly behind it."""
    shown, *ghosts = (scene_of(one, None, None, 0) for one in (motion, *others))
    window = window_on(shown, ghosts)
    painter = Painter(shown, window)
    sketch = layered(painter)
    names = label_shapes(shown, placed(point_letters(painter), sketch, window.width, window.height))
    wide, high = complex(window.width), complex(0.0, window.height)
    paper = Polygon((0j, wide, wide + high, high), "paper")
    shapes = (paper, *(ghost_shapes(scene, window) for scene in ghosts), *sketch, *names)
    return ck.results.Picture(shapes, window.width, window.height, motion.mechanism.title, window=window)


def burmester() -> ck.results.Picture:
    """The curves of centre and circle points through four poses."""
    poses = [(-0.48, -0.4, -81.0), (0.63, -0.82, 57.0), (0.2, 0.46, 22.0), (-0.62, -0.89, -126.0)]
    found: ck.results.Picture = ck.dyads([(x, y, ck.deg(angle)) for x, y, angle in poses]).draw()
    return found


def cognates() -> ck.results.Picture:
    """Roberts' three linkages of one coupler curve."""
    links = ck.link("crank", A=0, B=2), ck.link("coupler", B=0, C=5, P=(2, 1.5)), ck.link("rocker", D=0, C=4)
    four_bar = ck.Mechanism("Crank-rocker", ck.link("frame", A=0, D=5), *links, ck.drive("crank"))
    found: ck.results.Picture = ck.cognates(four_bar, "P").draw()
    return found


FIGURES: dict[str, Callable[[], ck.results.Picture | ck.results.Animation]] = {
    "moving": lambda: ck.animate(SIX_BAR, paths="G"),
    "crank-rocker": lambda: made_on("index.md"),
    "six-bar": six_bar,
    "apart": lambda: ck.draw(posed(), kind="groups"),
    "graph": lambda: ck.draw(SIX_BAR, kind="graph"),
    "loops": lambda: ck.draw(posed(), kind="loops"),
    "construction": lambda: ck.draw(load("crank-rocker"), ck.deg(60), kind="construction"),
    "modes": modes,
    "led": lambda: ck.animate(load("five-bar-led"), paths="P"),
    "limit": limit,
    "transmission": transmission,
    "workspace": workspace,
    "centres": lambda: ck.draw(SIX_BAR, AT, centres=True),
    "circle": lambda: ck.draw(SIX_BAR, kind="circle"),
    "velocities": lambda: ck.draw(SIX_BAR, AT, kind="polygon"),
    "conjugate-cams": lambda: ck.draw(load("conjugate-cams"), ck.deg(60)),
    "constant-breadth-yoke": lambda: ck.draw(load("constant-breadth-yoke"), ck.deg(60)),
    "free-bodies": lambda: ck.draw(load("engine-gas-pressure"), ck.deg(30), kind="free-bodies"),
    "along-bars": lambda: ck.draw(load("engine-gas-pressure"), ck.deg(75), kind="bending-moment"),
    "burmester": burmester,
    "cognates": cognates,
    "student-four-bar": lambda: made_on("for-students.md", "four_lengths"),
    "student-construction": lambda: made_on("for-students.md", "construction"),
    "student-velocities": lambda: made_on("for-students.md", "velocities"),
    "student-centres": lambda: made_on("for-students.md", "crossings"),
    "engineer-forces": lambda: made_on("for-engineers.md", "bodies"),
    "accelerations": lambda: ck.draw(SIX_BAR, AT, kind="polygon", vectors="acceleration"),
}


# The figures of the paper, whose printers take no SVG.
PAPER = ("apart", "burmester")

if __name__ == "__main__":
    for name, figure in FIGURES.items():
        figure().save(FOLDER / f"{name}.svg")
    for name in PAPER:
        FIGURES[name]().save(FOLDER.parents[1] / "paper" / f"{name}.png")
