"""Records as the fields of a share string, in the order of the grammar of 2026."""

from __future__ import annotations

from compoundkin.files.exchange.pmks_plus.packed_numbers import packed_decimal, packed_flags, packed_integer
from compoundkin.files.exchange.pmks_plus.shared_records import (
    SharedForce,
    SharedJoint,
    SharedLink,
    SharedMechanism,
    SharedSettings,
)

# Colours that links are told apart by.
_COLOURS = ("c5cae9", "303e9f", "0d125a", "b2dfdb", "26a69a", "00695c")


def body_of(shared: SharedMechanism) -> str:
    """Return a share string without its check character. Nothing of it is selected."""
    joints = "".join(f"{_joint(joint)}." for joint in shared.joints)
    colours = iter(range(len(shared.links)))
    links = "".join(f"{_link(link, '' if link.is_block else _COLOURS[next(colours) % 6])}." for link in shared.links)
    forces = "".join(f"{_force(force)}." for force in shared.forces)
    return f"{_settings(shared.settings)}.{joints}.{links}.{forces}.N_"


def _settings(settings: SharedSettings) -> str:
    """Return the four sections of settings. Grids and ids are shown, and forces where there are any."""
    flags = packed_flags([settings.clockwise, settings.has_gravity, False, True, True, True, False, True])
    decimals = f"{packed_decimal(settings.mark_size)},{packed_decimal(settings.linear_speed or 0.0)}"
    force, system = (0, 0) if settings.length == 0 else (1, settings.length)
    return f"{flags}.{decimals}.{packed_integer(round(settings.rpm))},0.{settings.length}0{force}{system}"


def _joint(joint: SharedJoint) -> str:
    flags = [joint.slides, joint.is_input, joint.is_grounded, joint.is_welded, joint.has_curve, joint.is_sealed]
    fields = [packed_flags(flags) + joint.id, joint.name, *_place(joint.at), packed_decimal(joint.angle)]
    if joint.slot or joint.speed:
        fields += joint.slot or ("", "", "")
    if joint.speed:
        fields.append(packed_decimal(joint.speed))
    return ",".join(fields)


def _link(link: SharedLink, colour: str) -> str:
    kind = "P" if link.is_block else "R"
    numbers = [packed_decimal(link.mass), packed_decimal(link.inertia), *_place(link.centre)]
    return ",".join([f"{link.flag}{kind}{link.id}", link.name, *numbers, colour, *link.joints, "", ""])


def _force(force: SharedForce) -> str:
    flags = packed_flags([force.turns, force.points_out])
    numbers = [*_place(force.start), *_place(force.end), packed_decimal(force.size)]
    return ",".join([f"{flags}{force.id}", force.link, force.name, *numbers])


def _place(at: complex) -> tuple[str, str]:
    return packed_decimal(at.real), packed_decimal(at.imag)
