"""What ties a model's joints together: pins that close loops, halves of links, wheels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element, SubElement

from compoundkin.files.exchange.mjcf.body_elements import site_name
from compoundkin.files.exchange.mjcf.elementary_joints import JointChain
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan
from compoundkin.files.exchange.shortest_numbers import shortest


def constraint_elements(plan: ModelPlan, tendons: Element) -> Iterator[Element]:
    """Yield all tendons, then all equality constraints.

    Tendons of loads are given; sums of joints that are held are added.
    """
    held = Element("equality")
    for chain in plan.connected:
        SubElement(held, "connect", _sites(plan, chain))
    for name, (_, link) in plan.halves.items():
        # angles count as much as lengths
        SubElement(held, "weld", name=name, body1=link, body2=name, torquescale=shortest(plan.size))
    for name, tie in plan.ties.items():
        _add_tie(plan, name, tie, held, tendons)
    yield from (element for element in (tendons, held) if len(element))


def _sites(plan: ModelPlan, chain: JointChain) -> dict[str, str]:
    letter = chain.pair.letters[0]
    one, two = (site_name(plan, letter, link) for link in chain.members)
    return {"name": chain.pair.name, "site1": one, "site2": two}


def _add_tie(plan: ModelPlan, name: str, tie: Mapping[str, float], held: Element, tendons: Element) -> None:
    """Add a joint that follows another, or the sum of several joints that stays."""
    scaled = {joint: factor / plan.unit_of(joint) for joint, factor in tie.items()}
    if not scaled:
        return
    (last, whole), *others = reversed(scaled.items())
    if len(others) > 1:
        SubElement(held, "tendon", name=name, tendon1=name)
        fixed = SubElement(tendons, "fixed", name=name)
        for joint, factor in scaled.items():
            SubElement(fixed, "joint", joint=joint, coef=shortest(factor))
        return
    words = {"name": name, "joint1": last, "polycoef": "0 0 0 0 0"}
    for joint, factor in others:
        words |= {"joint2": joint, "polycoef": f"0 {shortest(-factor / whole)} 0 0 0"}
    SubElement(held, "joint", words)
