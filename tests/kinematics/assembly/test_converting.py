"""Groups of real mechanisms: every configuration is a root of the pairs' own equations, the solved motion is one."""

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.base.series import Series
from compoundkin.files import load
from compoundkin.kinematics.assembly import all_configurations, from_group
from compoundkin.kinematics.groups.group_equations import GroupEquations, Member
from compoundkin.kinematics.solving_order import SolvingOrder


def attached(mechanism, **drives):
    """The first group, its surroundings at the driver values (poses,), and the size."""
    solving_order = SolvingOrder(ck.decompose(mechanism))
    given = {name: Series((np.atleast_2d(value),)) for name, value in drives.items()}
    shape = np.broadcast_shapes(*(series.c[0].shape for series in given.values()))
    return (
        solving_order.structure.groups[0],
        solving_order.start(solving_order.ends, given, 0, shape),
        solving_order.size,
    )


def as_general(group, size):
    where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
    pairs = (*group.inner, *group.outer)
    members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in pairs)
    return GroupEquations(len(group.bodies), pairs, members, size)


def all_close(mechanism, **drives):
    """All configurations; each real one is a root of the group's own equations."""
    group, setting, size = attached(mechanism, **drives)
    found = all_configurations(from_group(group, setting, size))
    general = as_general(group, size)
    assert found.real.any(axis=-1).all()
    for k in range(found.states.shape[-2]):
        here = found.real[..., k]
        solution = general.newton(general.state(found.poses(k)), setting, steps=1)
        assert np.all(solution.moved[here] < 1e-9)
        assert np.all(solution.closed[here])
        assert not np.any(solution.closed[~here])
    return group, found


def matches(motion, group, found):
    """Some configuration has the angles of the solved motion, at every pose."""
    angles = np.stack([motion.links[body.links[0]].angle for body in group.bodies], axis=-1)
    apart = np.abs(np.exp(1j * angles)[:, None] - np.exp(1j * found.states[0, ..., 2::3])).max(axis=-1)
    return np.all(np.nanmin(apart, axis=-1) < 1e-8)


def test_class_iii_six_bar():
    mechanism = load("class-iii-six-bar")
    crank = np.deg2rad(np.arange(0, 361, 30))
    group, found = all_close(mechanism, crank=crank)
    assert found.turns.shape[:3] == (1, 13, 6)
    assert found.certified.all()
    assert found.real_count[0, 0] == 6
    motion = ck.solve(mechanism, {"crank": crank})
    assert motion.assembled.all()
    assert matches(motion, group, found)


def test_a_driver_inside_the_group():
    """Two links joined by a driven pin are one body, whose shape differs from pose to pose."""
    mechanism = load("stephenson-iii-floating-driver")
    motion = ck.solve(mechanism)
    group, found = all_close(mechanism, EF=motion.drives["EF"].value)
    assert found.certified.all()
    assert matches(motion, group, found)


def test_a_group_with_a_slide():
    mechanism = ck.Mechanism(
        "three legs, one with a slide",
        ck.link("frame", A=(0, 0), B=(6, 0), C=(2, 7), S=(2, 7)),
        ck.link("crank", A=(0, 0), K=(0.5, 0)),
        ck.link("one", K=(0, 0), P=(4, 0)),
        ck.link("two", B=(0, 0), Q=(4.5, 0)),
        ck.link("bar", C=(0, 0)),
        ck.link("plate", P=(0, 0), Q=(3, 0), R=(1.5, 2.0)),
        ck.slide("plate", on="bar", at="R", through="C", turn=0.3, name="guide"),
        ck.drive("crank"),
    )
    _, found = all_close(mechanism, crank=np.linspace(0, 2 * np.pi, 9))
    assert np.all(found.count == 6)  # RR,RR,RP in the reference list of triads
    assert not found.certified.any()


def test_dyads_too():
    mechanism = load("crank-rocker")
    name = next(iter(ck.decompose(mechanism).mechanism.drives)).name
    _, found = all_close(mechanism, **{name: np.linspace(0.1, 6, 7)})
    assert found.real_count.tolist() == [[2] * 7]


def test_higher_pairs_are_told():
    group, setting, size = attached(load("crank-rocker"), crank=0.3)

    class Higher:
        name, title, held, members = "mesh", "gear pair", 1, ("a", "b", "c")

    broken = type(group)(group.bodies, (Higher(),), group.outer, group.name, group.class_, group.order)
    with pytest.raises(InvalidInput, match="lower pairs only"):
        from_group(broken, setting, size)


def test_what_rolls_is_neither_pin_nor_slide():
    """A wheel comes to another place after every turn: motions were sent on to poses that do not close."""
    rolls = [
        ck.roll("wheel", on="frame", through="A", toward="D", at="C", radius=1.0),
        ck.roll_around("wheel", on="frame", centre_at="D", at="C", circle=1.0, radius=1.0),
    ]
    for roll in rolls:
        links = (ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=3))
        mechanism = ck.Mechanism("Rolling", *links, ck.link("wheel", C=0, E=0.5), roll, ck.drive("crank"))
        group, setting, size = attached(mechanism, crank=0.3)
        with pytest.raises(InvalidInput, match="lower pairs only"):
            from_group(group, setting, size)
