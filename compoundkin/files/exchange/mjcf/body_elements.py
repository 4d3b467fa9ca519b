"""The bodies of a model, one in another: where they are drawn, their joints, masses and points."""

from __future__ import annotations

from cmath import phase
from xml.etree.ElementTree import Element, SubElement

from compoundkin.files.exchange.mjcf.elementary_joints import ElementaryJoint
from compoundkin.files.exchange.mjcf.joint_tree import CarriedLink
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan
from compoundkin.files.exchange.shortest_numbers import shortest
from compoundkin.model.geometry import FRAME


def place(value: complex) -> str:
    """Return a place of the plane."""
    return f"{shortest(value.real)} {shortest(value.imag)} 0"


def site_name(plan: ModelPlan, letter: str, link: str) -> str:
    """Return the name of a link's point.

    It is the letter on the first link that has it.

    >>> from compoundkin.files.exchange.mjcf.model_plan import plan_of
    >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
    >>> from compoundkin.files import load
    >>> plan = plan_of(shown_mechanism(load("slider-crank")))
    >>> site_name(plan, "A", "crank"), site_name(plan, "A", "rod")
    ('A', 'A on rod')
    """
    return letter if plan.shown.mechanism.carriers[letter][0] == link else f"{letter} on {link}"


def body_elements(plan: ModelPlan) -> dict[str, Element]:
    """Return the bodies of all links, each in that of its parent.

    The first is the frame's.
    """
    world = Element("worldbody")
    _add_sites(plan, world, FRAME)
    elements = {FRAME: world}
    for name, (branch, link) in plan.bodies.items():
        body = SubElement(elements[branch.parent], "body", {"name": name, **_pose(plan, branch, link)})
        mass = plan.part(link)
        SubElement(
            body,
            "inertial",
            pos=place(mass.centre),
            mass=shortest(mass.mass),
            diaginertia=" ".join([shortest(mass.inertia)] * 3),
        )
        for joint in branch.joints:
            _add_joint(plan, body, joint, link)
        if name == link:
            elements[link] = body
            _add_sites(plan, body, link)
    return elements


def _pose(plan: ModelPlan, branch: CarriedLink, link: str) -> dict[str, str]:
    local = plan.pose(branch.parent).inverse().compose(plan.pose(link))
    pos = place(complex(local.z.c[0]) * plan.units.length)
    angle = phase(complex(local.u.c[0]))
    return {"pos": pos, "euler": f"0 0 {shortest(angle)}"} if angle else {"pos": pos}


def _add_joint(plan: ModelPlan, body: Element, joint: ElementaryJoint, link: str) -> None:
    back = plan.pose(link).inverse()
    scale = 1.0 if joint.is_hinge else plan.units.length
    words = {"name": joint.name, "type": "hinge" if joint.is_hinge else "slide"}
    if joint.is_hinge:
        words |= {"pos": place(complex(back.at(joint.axis).c[0]) * plan.units.length), "axis": "0 0 1"}
    else:
        words |= {"axis": place(complex(back.u.c[0]) * joint.axis)}
    if joint.reach is not None:
        words["range"] = " ".join(shortest(end * scale) for end in joint.reach)
    SubElement(body, "joint", words)


def _add_sites(plan: ModelPlan, body: Element, link: str) -> None:
    for letter, own in plan.shown.points[link].items():
        SubElement(body, "site", name=site_name(plan, letter, link), pos=place(own * plan.units.length))
