"""The gallery of letters: twenty-six drawn in one stroke each, and the linkages that write them, moving.

Run `python -m tests.letters find` to look for linkages (about ten minutes), of all letters or of those that are named;
`python -m tests.letters` draws the picture of those that were found.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.dimensional.curve_likeness import mean_distance
from compoundkin.files.mechanism_files import written_text
from compoundkin.files.writer import document

DOCS = Path(__file__).parents[1] / "docs"
FOLDER, PICTURE, PAGE = DOCS / "letters", DOCS / "letters.svg", DOCS / "letters.md"
# Between these the table stands on the page.
BEGIN, END = "<!-- letters -->", "<!-- end -->"
# Places that the pen goes through, in an alphabet of our own, 100 high.
STROKES = {
    "A": [(0, 0), (18, 60), (30, 98), (42, 60), (60, 4), (64, 14), (48, 34), (4, 34)],
    "B": [(5, 0), (5, 50), (8, 98), (40, 95), (48, 75), (35, 55), (14, 52), (45, 46), (55, 25), (40, 3), (5, 0)],
    "C": [(58, 82), (35, 100), (8, 80), (0, 50), (8, 20), (35, 0), (58, 18)],
    "D": [(0, 0), (0, 50), (3, 98), (38, 88), (55, 50), (38, 10), (0, 0)],
    "E": [(55, 92), (28, 100), (6, 82), (14, 60), (36, 52), (10, 46), (0, 22), (22, 0), (55, 10)],
    "F": [(55, 98), (14, 96), (7, 50), (6, 0), (8, 30), (16, 50), (44, 54)],
    "G": [(58, 82), (35, 100), (8, 80), (0, 50), (8, 18), (35, 0), (57, 18), (56, 44), (32, 44)],
    "H": [(0, 100), (2, 50), (2, 2), (6, 36), (28, 60), (50, 46), (56, 0)],
    "I": [(20, 100), (22, 75), (22, 50), (22, 25), (20, 0)],
    "J": [(45, 100), (46, 60), (45, 28), (34, 4), (16, 0), (2, 18)],
    "K": [(4, 100), (2, 50), (0, 2), (10, 38), (46, 88), (16, 52), (56, 0)],
    "L": [(5, 100), (2, 50), (5, 6), (28, 0), (56, 4)],
    "M": [(0, 0), (8, 92), (30, 40), (52, 92), (60, 0)],
    "N": [(0, 0), (6, 94), (30, 50), (52, 6), (58, 100)],
    "O": [(28, 100), (6, 80), (0, 50), (6, 20), (28, 0), (50, 20), (56, 50), (50, 80), (28, 100)],
    "P": [(4, 0), (4, 50), (8, 96), (44, 94), (53, 72), (36, 50), (8, 46)],
    "Q": [(66, -6), (40, 26), (52, 46), (52, 76), (30, 100), (6, 78), (4, 28), (26, 2), (48, 14), (58, 40)],
    "R": [(4, 0), (5, 50), (9, 96), (44, 94), (50, 72), (32, 54), (14, 50), (36, 30), (58, 0)],
    "S": [(54, 84), (32, 100), (9, 84), (14, 62), (34, 50), (52, 34), (50, 12), (28, 0), (2, 14)],
    "T": [(2, 94), (34, 100), (58, 97), (36, 88), (30, 50), (29, 0)],
    "U": [(0, 100), (2, 30), (14, 3), (42, 3), (55, 30), (58, 100)],
    "V": [(0, 100), (24, 12), (29, 4), (34, 12), (58, 100)],
    "W": [(0, 100), (14, 6), (30, 62), (46, 6), (60, 100)],
    "X": [(0, 100), (28, 50), (56, 4), (70, 50), (56, 96), (28, 50), (0, 0)],
    "Y": [(0, 100), (12, 64), (32, 58), (56, 100), (42, 34), (20, -12)],
    "Z": [(4, 96), (52, 97), (30, 50), (6, 4), (56, 5)],
}
HIGH, POINTS = 100.0, 120
# Of linkages with such a mean distance, or little worse than the best, the smallest is taken; where its links together
# are longer than so many heights, or it is farther, eight links are tried.
ENOUGH, POORER, LONGEST = 0.7, 1.3, 12.0
# Steps of the crank along a stroke; pictures of a turn, its seconds, and the cells of the picture in pixels.
STEPS, FRAMES, SECONDS, ACROSS, CELL, MARGIN = 40, 40, 6, 6, 400, 28
STYLE = (
    "path{fill:none;stroke-linecap:round;stroke-linejoin:round}.w{stroke:#cc79a7;stroke-opacity:.45;stroke-width:12}"
    ".s{stroke:#0067b1;stroke-width:3.6}.b{fill:#5b6470;fill-opacity:.1;stroke:#5b6470;stroke-width:4.4}"
    ".g{fill:#1b1f24}.p{stroke:#0067b1;stroke-width:14}"
)


def letter(name: str) -> np.ndarray:
    """The places along a letter, complex (POINTS,): a spline through those of its stroke."""
    from scipy.interpolate import CubicSpline

    z = np.array([complex(*place) for place in STROKES[name]])
    along = np.append(0.0, np.cumsum(np.sqrt(np.abs(np.diff(z)))))
    ends = "periodic" if z[0] == z[-1] and name == "O" else "natural"
    fine = CubicSpline(along, z, bc_type=ends)(np.linspace(0.0, along[-1], 2000))
    arc = np.append(0.0, np.cumsum(np.abs(np.diff(fine))))
    return np.interp(np.linspace(0.0, arc[-1], POINTS), arc, fine)


def find(names: list[str]) -> None:
    """Look for linkages of letters and keep them as files, with the values of the crank along the stroke."""
    FOLDER.mkdir(exist_ok=True)
    for name in names or list(STROKES):
        for links in (6, 8):
            answer = ck.synthesise(ck.tasks.curve(letter(name), links=links))
            near = [one for one in answer if one.error < max(ENOUGH, POORER * answer[0].error)]
            best = min(near, key=lambda one: one.size)
            if best.error < ENOUGH and best.size < LONGEST * HIGH:
                break
        turn = 2.0 * np.pi if answer.task.closed else best.values[-1] - best.values[0]
        keep(name, best.candidate.mechanism(best.driver), best.driver, float(best.values[0]), turn)
        print(name, best.mechanism.title, f"{best.error:.2f}", f"{best.size:.0f}", flush=True)


def keep(name: str, mechanism: ck.Mechanism, driver: str, start: float, turn: float) -> None:
    """Write the linkage of a letter with rounded numbers, and its driver's values along the stroke."""
    whole = rounded(document(mechanism))
    first, step = round(float(np.rad2deg(start)), 3), round(float(np.rad2deg(turn)) / STEPS, 4)
    values = {"from": first, "to": round(first + STEPS * step, 4), "step": step}
    whole["drives"] = [{"link": driver, "values": values}]
    (FOLDER / f"{name}.toml").write_text(written_text(whole, "toml"), encoding="utf-8")


def rounded(value: Any) -> Any:
    """A document with its numbers rounded to a hundred-thousandth of a letter's height, or less of a degree."""
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [rounded(inner) for inner in value]
    return round(value, 3) + 0.0 if isinstance(value, float) else value


# --- the page and its picture ---------------------------------------------------------------------------------


def found() -> list[str]:
    """The letters that have a linkage."""
    return [name for name in STROKES if (FOLDER / f"{name}.toml").exists()]


def written(name: str) -> np.ndarray:
    """What the linkage of a letter writes along its stroke."""
    mechanism = ck.load(FOLDER / f"{name}.toml")
    (drive,) = mechanism.drives
    ends = np.asarray(drive.values)[[0, -1]]
    motion = ck.solve(mechanism, {drive.name: np.linspace(*ends, 32 * STEPS)}, order=0)
    return np.ravel(motion.points["P"].position)


def off(name: str) -> float:
    """The mean distance from a letter to what is written and back: evenly along both, to the lines."""
    z, curve = written(name), letter(name)
    closed = bool(abs(curve[0] - curve[-1]) < 1e-9)
    both = (curve[:-1], z[:-1]) if closed else (curve, z)
    return mean_distance(both[1], both[0], closed) * float(np.std(both[0])) / 2.0


def table() -> str:
    """The table of the page."""
    rows = ["| letter | linkage | links | off |", "|---|---|---|---|"]
    for name in found():
        mechanism = ck.load(FOLDER / f"{name}.toml")
        rows.append(f"| {name} | {mechanism.title} | {len(mechanism.links)} | {off(name):.2f} |")
    return "\n".join(rows)


def page() -> str:
    """The page with its table."""
    text = PAGE.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    return f"{head}{BEGIN}\n\n{table()}\n\n{END}{rest.split(END)[1]}"


def picture() -> str:
    """The source of the picture: a cell for each letter that has a linkage, all moving."""
    names = found()
    rows = -(-len(names) // ACROSS)
    cells = "\n".join(cell(name, k % ACROSS * CELL, k // ACROSS * CELL) for k, name in enumerate(names))
    wide = ACROSS * CELL
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {rows * CELL}" width="{wide // 2}">\n'
        f"<title>Letters, each written by a linkage</title>\n<style>{STYLE}</style>\n"
        f'<rect width="100%" height="100%" fill="#fff"/>\n{cells}\n</svg>\n'
    )


def cell(name: str, left: float, top: float) -> str:
    """The moving picture of one letter: the stroke that is wanted, the one that is written, the linkage."""
    mechanism = ck.load(FOLDER / f"{name}.toml")
    (drive,) = mechanism.drives
    values = np.asarray(drive.values)[0] + np.arange(FRAMES + 1) * (2.0 * np.pi / FRAMES)
    motion = ck.solve(mechanism, {drive.name: values}, order=0)
    at = {letter: np.ravel(point.position) + np.zeros(FRAMES + 1) for letter, point in motion.points.items()}
    wanted = letter(name)
    seen = np.concatenate([wanted, *at.values()])
    low, high = complex(seen.real.min(), seen.imag.min()), complex(seen.real.max(), seen.imag.max())
    scale = (CELL - 2 * MARGIN) / max((high - low).real, (high - low).imag)
    middle = (low + high) / 2.0

    def on_paper(z: np.ndarray) -> np.ndarray:
        return np.conj(np.atleast_1d(z) - middle) * scale + complex(CELL / 2, CELL / 2)

    def path(z: np.ndarray, digits: int = 0) -> str:
        return "M" + "L".join(f"{p.real:.{digits}f} {p.imag:.{digits}f}" for p in on_paper(z))

    def moving(frames: list[str]) -> str:
        return f'<animate attributeName="d" dur="{SECONDS}s" repeatCount="indefinite" values="{";".join(frames)}"/>'

    parts = [f"<title>{name}: {mechanism.title}</title>", f'<path class="w" d="{path(wanted, 1)}"/>']
    for link, own in mechanism.links.items():
        if link == "frame" or len(own.points) < 2:
            continue
        frames = [path(np.array([at[one][k] for one in own.points])) + "Z" for k in range(FRAMES + 1)]
        parts.append(f'<path class="b" d="{frames[0]}">{moving(frames)}</path>')
    parts.append(f'<path class="s" d="{path(written(name)[::4], 1)}"/>')
    for one in mechanism.links["frame"].points:
        place = on_paper(at[one][:1])[0]
        parts.append(f'<circle class="g" cx="{place.real:.1f}" cy="{place.imag:.1f}" r="7"/>')
    pen = [f"M{p.real:.0f} {p.imag:.0f}h.01" for p in on_paper(at["P"])]
    parts.append(f'<path class="p" d="{pen[0]}">{moving(pen)}</path>')
    return f'<g transform="translate({left} {top})">{"".join(parts)}</g>'


if __name__ == "__main__":
    if sys.argv[1:2] == ["find"]:
        find(sys.argv[2:])
    else:
        PICTURE.write_text(picture(), encoding="utf-8")
        PAGE.write_text(page(), encoding="utf-8")
