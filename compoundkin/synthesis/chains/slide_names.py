"""Names of loops of four links with slides, by their letters and frame.

Source: F. Reuleaux, The Kinematics of Machinery, 1876, ch. VIII (chains of three turning pairs and a sliding
pair, of two and two, and their inversions); J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines
and Mechanisms, on inversions.
"""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.synthesis.chains.joints import REVOLUTE, SLIDE, Joints

FOUR = 4
SLIDER_CRANK, INVERTED = "slider-crank", "inverted slider-crank"
# By the letters around the loop, then by those of the frame: the slide's own link, or the pins' link.
_NAMES = {
    ("RRRP", "RP"): SLIDER_CRANK,
    ("RRRP", "RR"): INVERTED,
    ("RRPP", "PP"): "elliptic trammel",
    ("RRPP", "RR"): "Oldham coupling",
    ("RRPP", "RP"): "Scotch yoke",
    ("RPRP", "RP"): "Rapson slide",
}
_CHAINS = {"RRRP": "slider-crank chain", "RRPP": "double slider chain", "RPRP": "crossed slider chain"}


def loop_letters(joints: Joints) -> str:
    """Return the letters around the only loop, those with R first.

    That is from where and in the direction in which they come first.
    "" where the links do not form one loop.

    >>> from compoundkin.synthesis.chains.joints import Joint
    >>> loop = [Joint((0, 1)), Joint((1, 2), "P"), Joint((2, 3)), Joint((3, 0))]
    >>> loop_letters(Joints(("a", "b", "c", "d"), tuple(loop)))
    'RRRP'
    """
    if any(joint.pairs > 1 for joint in joints.joints) or set(joints.degrees) != {2}:
        return ""
    link, passed = 0, [k for k, joint in enumerate(joints.joints) if 0 in joint.links][:1]
    while len(passed) < len(joints.joints):
        first, second = joints.joints[passed[-1]].links
        link = second if first == link else first
        onward = [k for k, joint in enumerate(joints.joints) if link in joint.links and k not in passed]
        if not onward:
            return ""
        passed.append(onward[0])
    letters = "".join(joints.joints[k].code for k in passed)
    turned = [text[k:] + text[:k] for text in (letters, letters[::-1]) for k in range(len(letters))]
    return min(turned, key=lambda text: [letter != REVOLUTE for letter in text])


@dataclass(frozen=True)
class SliderName:
    """The name of a four-link loop with slides, and of its chain."""

    title: str
    chain: str
    also: tuple[str, ...] = ()


def slider_name(joints: Joints, frame: int | None, driver: int | None) -> SliderName | None:
    """Return the name of a four-link loop with slides; None for any other mechanism.

    A pump's lever is a connecting rod: the slider-crank driven there is distinguished. Which link of a slide is
    the block and which one carries the guide is a matter of design, not of motion; where it is known it tells
    a lever with a slot (or a cylinder) that turns on the frame from a block that does.
    """
    letters = loop_letters(joints) if len(joints.links) == FOUR else ""
    if SLIDE not in letters or not set(letters) <= {REVOLUTE, SLIDE}:
        return None
    chain = _CHAINS.get(letters, f"four-link chain {letters}")
    if frame is None:
        return SliderName(chain, chain)
    own = _letters_of(joints, frame)
    name = _NAMES.get((letters, own), f"{chain}, frame {own}")
    detail, also = _detail(joints, frame, driver, name)
    return SliderName(name + detail, chain, also)


def _detail(joints: Joints, frame: int, driver: int | None, name: str) -> tuple[str, tuple[str, ...]]:
    guide = next(joint.guide for joint in joints.joints if joint.code == SLIDE)
    if name == SLIDER_CRANK:
        if driver is not None and _is_connecting_rod(joints, frame, driver):
            return " driven at the connecting rod", ("hand pump",)
        return (" with fixed block", ("hand pump",)) if guide not in (None, frame) else ("", ())
    if name == INVERTED and guide is not None:
        if any({frame, guide} <= set(joint.links) for joint in joints.joints):
            return " with turning or oscillating guide", (
                "Whitworth",
                "crank and slotted lever",
                "oscillating cylinder",
            )
        return " with swinging block", ("oscillating block",)
    return "", ()


def _is_connecting_rod(joints: Joints, frame: int, link: int) -> bool:
    joined = any({frame, link} <= set(joint.links) for joint in joints.joints)
    return not joined and link != frame


def _letters_of(joints: Joints, link: int) -> str:
    """Return the letters of a link's joints, R first."""
    return "".join(sorted((joint.code for joint in joints.joints if link in joint.links), reverse=True))
