"""How fast the joints of a model move at the pose as drawn, found from the velocities of the links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.files.exchange.mjcf.joint_tree import CarriedLink
from compoundkin.files.exchange.mjcf.model_plan import ModelPlan


def joint_rates(plan: ModelPlan) -> Mapping[str, float]:
    """Return the rates of all joints; zeros where some are not known.

    They are in radians or the mechanism's lengths a second.

    >>> from compoundkin.files.exchange.mjcf.model_plan import plan_of
    >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> round(joint_rates(plan_of(shown_mechanism(load_named("slider-crank"))))["A"], 9)
    1.0
    """
    found = {name: rate for branch, link in plan.bodies.values() for name, rate in _rates(plan, branch, link)}
    known = plan.shown.motion is not None and all(np.isfinite(rate) for rate in found.values())
    return found if known else dict.fromkeys(plan.joints, 0.0)


def _rates(plan: ModelPlan, branch: CarriedLink, link: str) -> Iterator[tuple[str, float]]:
    """Yield the rates of a body's joints: together they give its motion relative to its parent."""
    at = complex(plan.shown.poses[link].z.c[0])
    (turn, shift), (before, carried) = (_moved(plan.shown.poses[name], at) for name in (link, branch.parent))
    columns = [(1.0, 1j * (at - joint.axis)) if joint.is_hinge else (0.0, joint.axis) for joint in branch.joints]
    matrix = np.array([[w for w, _ in columns], [v.real for _, v in columns], [v.imag for _, v in columns]])
    right = np.array([turn - before, (shift - carried).real, (shift - carried).imag])
    if not np.all(np.isfinite(right)):
        yield from ((joint.name, np.nan) for joint in branch.joints)
        return
    # turns and shifts do not compare; each joint has one of them that the others have not
    rates = np.linalg.lstsq(matrix, right, rcond=None)[0]
    yield from ((joint.name, float(rate)) for joint, rate in zip(branch.joints, rates, strict=True))


def _moved(pose: Pose, at: complex) -> tuple[float, complex]:
    """Return how fast a link turns, and the velocity of its point at a place."""
    rates = [complex(part.c[1]) if part.order else 0j for part in (pose.z, pose.u)]
    turning = (rates[1] * complex(pose.u.c[0]).conjugate()).imag
    return turning, rates[0] + 1j * turning * (at - complex(pose.z.c[0]))
