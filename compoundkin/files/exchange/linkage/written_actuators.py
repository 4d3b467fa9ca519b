"""Driven lengths as actuators: links between two connectors that become longer or shorter."""

from __future__ import annotations

from cmath import rect

from compoundkin.files.exchange.drawings.drawn_elements import DrawnDriver, DrawnGuideway
from compoundkin.files.exchange.linkage.input_drivers import SECONDS
from compoundkin.files.exchange.linkage.linkage_elements import WrittenConnector
from compoundkin.files.exchange.linkage.linkage_plan import LinkagePlan
from compoundkin.files.exchange.linkage.standing_pins import CLOSE
from compoundkin.files.exchange.linkage.written_guides import APART, BEYOND


def write_actuator(
    plan: LinkagePlan, driver: DrawnDriver, name: str, ends: tuple[WrittenConnector, WrittenConnector]
) -> None:
    """Write a link between two connectors that becomes longer or shorter."""
    low, high = driver.travel or (0.0, BEYOND * plan.size)
    if driver.travel is None:
        plan.notes.append(f"{driver.link} has no range to be driven over: it goes {high:.4g} there")
    near = CLOSE * plan.size
    ahead = high >= -low if min(high, -low) <= near else (driver.speed or 0.0) >= 0
    made = plan.link([one.id for one in ends], driver.name or name)
    made.throw = high if ahead else -low
    if min(high, -low) > near:
        kept, lost = ("longest", "shortest") if ahead else ("shortest", "longest")
        plan.notes.append(f"{driver.link} goes from the pose written to its {kept} there, not to its {lost}")
    made.cpm = (1.0 if ahead else -1.0) * abs(driver.speed or 0.0) * SECONDS / (2.0 * made.throw)


def actuator_ends(
    plan: LinkagePlan, guide: DrawnGuideway, moving: WrittenConnector, on: str, driver: DrawnDriver, sense: float
) -> tuple[WrittenConnector, WrittenConnector]:
    """Return a connector behind a slide, and the slide's own. The length between them stays positive."""
    low = min(driver.travel[0] if driver.travel else 0.0, 0.0)
    behind = moving.at + sense * rect(low - APART * plan.size, guide.angle)
    return plan.connector(behind, [on]), moving
