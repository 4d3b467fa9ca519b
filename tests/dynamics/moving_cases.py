"""The mechanisms of the forward dynamics in `tests/reference/forces.json`, built from words."""

from __future__ import annotations

from typing import Any

import numpy as np

import compoundkin as ck
from tests.dynamics.cases import SI
from tests.support import reference

SQUEEZER = reference("andrews_squeezer", "forces")
ENTRY = reference("forward_slider_crank_four_bar_five_bar", "forces")


def slider_crank(driver: Any = None) -> ck.Mechanism:
    """The vertical slider-crank that is let go."""
    own = ENTRY["dimensions"]["slider_crank"]
    bodies = [ck.mass(link, own[link]["mass"], at=tuple(own[link]["mass_centre"]), inertia=own[link]["inertia"])
              for link in ("crank", "rod")]  # fmt: skip
    return ck.Mechanism(
        "Slider-crank let go",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(own["OA"], 0)),
        ck.link("rod", A=(0, 0), B=(own["AB"], 0)),
        ck.link("piston", B=(0, 0)),
        ck.slide("piston", on="frame", at="B", through="O", angle=np.pi / 2, name="guide"),
        ck.drawn(O=(0, 0), A=(own["OA"], 0), B=(0, 0.335)),
        driver or ck.drive("crank"),
        *bodies,
        ck.mass("piston", own["piston"]["mass"], at="B", inertia=0.0),
        ck.gravity(*own["gravity"]),
        units=SI,
    )


def four_bar() -> ck.Mechanism:
    """The four-bar driven by a constant torque."""
    own = ENTRY["dimensions"]["four_bar"]
    bodies = [ck.mass(link, own[link]["mass"], at=tuple(own[link]["mass_centre"]), inertia=own[link]["inertia"])
              for link in ("coupler", "rocker")]  # fmt: skip
    return ck.Mechanism(
        "Four-bar under a torque",
        ck.link("frame", O=(0, 0), C=(own["OC"], 0)),
        ck.link("crank", O=(0, 0), A=(own["OA"], 0)),
        ck.link("coupler", A=(0, 0), B=(own["AB"], 0)),
        ck.link("rocker", C=(0, 0), B=(own["CB"], 0)),
        ck.drawn(O=(0, 0), C=(own["OC"], 0), A=(own["OA"], 0), B=(0.19, 0.12)),
        ck.drive("crank"),
        # about the pivot: what the mass adds at a distance is in it
        ck.mass("crank", 1e-9, at="O", inertia=own["crank_inertia_about_O"]),
        *bodies,
        ck.torque("crank", own["torque"]),
        units=SI,
    )


def five_bar() -> ck.Mechanism:
    """The pendulum of five bars, with two freedoms."""
    own = ENTRY["dimensions"]["five_bar"]
    bars = {"left": "cranks", "right": "cranks", "left rod": "rods", "right rod": "rods"}
    weights = {"cranks": own["crank_mass"], "rods": own["rod_mass"]}
    return ck.Mechanism(
        "Five-bar let go",
        ck.link("frame", A=own["A"], D=own["D"]),
        ck.link("left", A=(0, 0), P=(own["cranks"], 0)),
        ck.link("right", D=(0, 0), R=(own["cranks"], 0)),
        ck.link("left rod", P=(0, 0), Q=(own["rods"], 0)),
        ck.link("right rod", R=(0, 0), Q=(own["rods"], 0)),
        ck.drawn(A=(0, 0), D=(0.2, 0), P=(0, 0.1), R=(0.25, 0.09), Q=(0.1, 0.3)),
        ck.drive("left"),
        ck.drive("right"),
        *(ck.mass(link, weights[kind], at=(own[kind] / 2, 0), inertia=weights[kind] * own[kind] ** 2 / 12)
          for link, kind in bars.items()),
        ck.gravity(*own["gravity"]),
        units=SI,
    )  # fmt: skip


def squeezer(torque: bool = True) -> ck.Mechanism:
    """Andrews' squeezer with its masses and its spring. The torque may be left out."""
    own = SQUEEZER["dimensions"]
    places = {
        "K1": own["ra"],
        "K2": own["d"] - own["da"],
        # the distance from B alone matters
        "K3": 1j * (own["ss"] - abs(complex(own["sa"], own["sb"]))),
        "K4": 1j * own["ea"],
        "K5": complex(own["ta"], own["tb"]),
        "K6": own["zf"] - own["fa"],
        "K7": complex(own["ua"], -own["ub"]),
    }
    masses = [
        ck.mass(link, own[f"m{k}"], at=at, inertia=own[f"i{k}"]) for k, (link, at) in enumerate(places.items(), 1)
    ]
    spring = ck.spring("K3", "D", to="frame", at="C", stiffness=own["c0"], free_length=own["l0"])
    words = [*masses, spring, *([ck.torque("K1", own["mom"])] if torque else [])]
    return ck.load("andrews-squeezer").replace(*words, units=SI)


def squeezer_angles(motion: Any, k: int = 0) -> list[np.ndarray]:
    """Return the test set's seven coordinates, or their rates."""
    word = ("angle", "angular_velocity", "angular_acceleration")[k]
    angle = {link: getattr(motion.links[link], word) for link in motion.mechanism.links}
    beta, gamma, delta, epsilon = (angle[link] for link in ("K1", "K3", "K5", "K7"))
    return [beta, angle["K2"] - beta, gamma, angle["K4"] - delta, delta, angle["K6"] - epsilon, epsilon]
