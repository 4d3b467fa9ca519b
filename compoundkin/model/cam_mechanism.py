"""The mechanism of a synthesised cam: shaft, follower, guide or pivot, and the cam pairs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN
from compoundkin.model.elements import drive, link, mode
from compoundkin.model.fields import Item
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.cam import cam
from compoundkin.model.pairs.face import face
from compoundkin.model.pairs.prismatic import slide
from compoundkin.model.profiles.double_cams import DoubleCam
from compoundkin.model.profiles.synthesised import Synthesised

# Five degrees from pose to pose.
POSES = 73
FRAME, CAM, FOLLOWER = "frame", "cam", "follower"


@checked
def cam_mechanism(cams: Synthesised | DoubleCam, *, title: str = "", unit: str = "") -> Mechanism:
    """Return the mechanism of a made cam, or of two, with its follower.

    The links are called frame, cam and follower; A is the axis of the cam, H the pivot of an oscillating follower, P
    its edge, roller or face on the first profile and Q that on the second. The cam turns once, in the way of its
    program. Where there are two profiles, the second pair holds what the first one holds already: the mechanism is
    overconstrained and moves all the same, which `solve` finds out and checks.

    >>> from compoundkin.model.laws import fall, program, rise
    >>> from compoundkin.model.profiles.double_cams import conjugate
    >>> cams = conjugate(program(rise(20, over=np.pi), fall(20, over=np.pi)), base=40, roller=10)
    >>> cam_mechanism(cams).link("follower").points["Q"]
    (-120+0j)
    """
    both = cams if isinstance(cams, DoubleCam) else DoubleCam(cams, cams)
    items = [*_links(both, double=both is cams), *_pairs(both, double=both is cams)]
    name = title or (
        "Disc cam with its follower" if both is not cams else "Yoke cam" if both.is_single else "Conjugate cams"
    )
    way = -TURN if both.first.clockwise else TURN
    driven = drive(CAM, values=both.first.start + np.linspace(0.0, way, POSES))
    return Mechanism(name, *items, driven, mode(both.first.mode, FOLLOWER), unit=unit)


def _links(cams: DoubleCam, double: bool) -> Iterator[Item]:
    made = cams.first
    pivot = {} if made.pivot is None else {"H": made.pivot}
    yield link(FRAME, A=0, **pivot)
    yield link(CAM, A=0)
    if made.pivot is None:
        yield link(FOLLOWER, P=0, **({"Q": -cams.apart} if double else {}))
        yield slide(FOLLOWER, on=FRAME, at="P", through="A", angle=made.angle, offset=made.offset)
    else:
        back = np.exp(-1j * made.side * cams.apart)
        other = {"Q": _end(cams.second) * back} if double else {}
        yield link(FOLLOWER, H=0, P=_end(made), **other)


def _end(made: Synthesised) -> complex:
    """Return the end of an oscillating follower, its arm or face along its x axis."""
    return made.side * made.face * 1j if made.follower == "flat" else complex(made.arm)


def _pairs(cams: DoubleCam, double: bool) -> Iterator[Item]:
    yield _pair(cams.first, "P", 0.0, 1, "")
    if double:
        turned = -cams.first.side * cams.apart if cams.oscillates else 0.0
        # the one disc of a yoke is touched from behind
        yield _pair(cams.second, "Q", turned, 1 if cams.oscillates else -1, f"{FOLLOWER}/{CAM} 2")


def _pair(made: Synthesised, at: str, turned: float, way: int, name: str) -> Item:
    if made.follower != "flat":
        return cam(FOLLOWER, on=CAM, at=at, profile=made, radius=made.roller, name=name)
    if made.oscillates:
        return face(FOLLOWER, on=CAM, at=at, profile=made, angle=turned, side=-made.side, name=name)
    return face(FOLLOWER, on=CAM, at=at, profile=made, angle=np.pi / 2.0, side=way, name=name)
