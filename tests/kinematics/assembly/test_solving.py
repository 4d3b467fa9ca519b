"""Properties of all configurations: completeness, truth of each, invariance, order, poses that cannot be solved."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compoundkin.base.errors import InvalidInput
from compoundkin.kinematics.assembly import Connection, GroupGeometry, all_configurations, elimination, homotopy
from compoundkin.kinematics.assembly.loop_closure import rotation_equations_of
from compoundkin.kinematics.assembly.rotation_equations import distinct, polish
from tests.kinematics.assembly.cases import dyad, joined, triad, with_slides
from tests.kinematics.assembly.trusses import baranov_trusses, random_truss

SMALL = [*baranov_trusses(5), *baranov_trusses(7)]
seeds = st.integers(0, 2**32 - 1)


def gap(geometry, found):
    """The largest failure of any connection in any real configuration."""
    worst = 0.0
    for c in geometry.connections:
        sides = []
        for body, point in zip(c.bodies, c.points, strict=True):
            at = np.asarray(point)[..., None]
            u = np.ones(1) if body is None else found.turns[..., body]
            origin = np.zeros(1) if body is None else found.origins[..., body]
            sides.append((origin + u * at, u))
        apart = np.broadcast_to(sides[1][0] - sides[0][0], found.real.shape)[found.real]
        if c.directions is not None:
            along = np.broadcast_to(sides[0][1] * c.directions[0], found.real.shape)[found.real]
            block = np.broadcast_to(sides[1][1] * c.directions[1], found.real.shape)[found.real]
            worst = max(worst, np.abs(block - along).max(initial=0.0))
            apart = (apart * along.conj()).imag
        worst = max(worst, np.abs(apart).max(initial=0.0))
    return worst


def drawn_is_among(found):
    """The random cases are drawn in the world's frame: all turns 1, all origins 0."""
    state = np.zeros(found.states.shape[-1])
    return np.abs(found.states - state).max(axis=-1).min() < 1e-8


@pytest.mark.parametrize("word", ["RRR", "RRP", "RPR", "PRP", "RPP"])
@settings(max_examples=8)
@given(seed=seeds)
def test_dyads(word, seed):
    geometry = dyad(word, np.random.default_rng(seed))
    found = all_configurations(geometry)
    assert found.count == found.possible == (1 if word.count("P") == 2 else 2)
    assert gap(geometry, found) < 1e-10 * geometry.size
    assert drawn_is_among(found)


@given(seed=seeds, which=st.integers(0, len(SMALL) - 1))
def test_pinned_groups_are_complete(seed, which):
    geometry = random_truss(SMALL[which], np.random.default_rng(seed), seed % len(SMALL[which]))
    found = all_configurations(geometry)
    assert found.certified
    assert found.count in ((6,) if geometry.n == 4 else (14, 16, 18))
    assert gap(geometry, found) < 1e-10 * geometry.size
    assert found.real_count % 2 == 0
    assert drawn_is_among(found)


@pytest.mark.full
@settings(max_examples=5)
@given(seed=seeds, which=st.integers(0, len(SMALL) - 1), number=st.integers(1, 2))
def test_groups_with_slides_are_complete(seed, which, number):
    geometry = with_slides(SMALL[which], number, np.random.default_rng(seed))
    try:
        found = all_configurations(geometry)
    except InvalidInput:
        return
    assert found.count == found.possible
    assert not found.certified
    assert gap(geometry, found) < 1e-9 * geometry.size
    assert drawn_is_among(found)


def moved(geometry, turn, shift, scale):
    """The known points turned, shifted and scaled, the bodies scaled."""
    connections = []
    for c in geometry.connections:
        points = tuple(
            scale * p if b is not None else scale * (turn * p + shift) for b, p in zip(c.bodies, c.points, strict=True)
        )
        directions = c.directions and tuple(
            d if b is not None else turn * d for b, d in zip(c.bodies, c.directions, strict=True)
        )
        connections.append(Connection(c.bodies, points, directions))
    return GroupGeometry(geometry.n, tuple(connections), geometry.size * scale)


@pytest.mark.parametrize("word", ["RR,RR,RR", "RR,PR,RP"])
@settings(max_examples=8)
@given(seed=seeds)
def test_turned_shifted_and_scaled(word, seed):
    rng = np.random.default_rng(seed)
    geometry = triad(word, rng)
    turn, shift, scale = np.exp(1j * rng.uniform(-3, 3)), complex(*rng.uniform(-3, 3, 2)), rng.uniform(0.01, 100)
    one, other = all_configurations(geometry), all_configurations(moved(geometry, turn, shift, scale))
    assert one.count == other.count
    assert one.real_count == other.real_count
    a, b = (turn * one.turns)[one.real], other.turns[other.real]
    apart = np.abs(a[:, None] - b[None]).max(axis=-1)
    assert np.all(apart.min(axis=0) < 1e-7)
    assert np.all(apart.min(axis=1) < 1e-7)


@settings(max_examples=5)
@given(seed=seeds)
def test_eigenvectors_and_paths_find_the_same(seed):
    geometry = random_truss(SMALL[seed % len(SMALL)], np.random.default_rng(seed))
    loops, structure = rotation_equations_of(geometry).flat, geometry.graph()
    one = elimination.complex_solutions(loops, structure)[0]
    other = distinct(polish(loops, homotopy.roots(loops, structure)))[0]
    assert len(one) == len(other)
    apart = (np.abs(one[:, None] - other[None]) / np.abs(one[:, None])).max(axis=-1)
    assert np.all((apart < 1e-6).sum(axis=0) == 1)


def turning(word, poses):
    """A triad one of whose outer points goes round a circle, from and to the drawn pose."""
    geometry = triad(word, np.random.default_rng(3))
    first, *others = geometry.connections
    circle = 0.5 * (np.exp(1j * np.linspace(0, 2 * np.pi, poses)) - 1)
    moving = Connection(first.bodies, (first.points[0] + circle, first.points[1]), first.directions)
    return GroupGeometry(geometry.n, (moving, *others), geometry.size)


@pytest.mark.parametrize("word", ["RR,RR,RR", "RR,RR,PR", "RR,RP,RP"])
def test_many_poses_are_each_as_one(word):
    many = turning(word, 40)
    found = all_configurations(many)
    assert found.turns.shape == (40, found.possible, 4)
    assert np.all(found.count == found.possible)
    assert gap(many, found) < 1e-10 * many.size
    for k in (0, 7, 23):
        first = many.connections[0]
        single = Connection(first.bodies, (first.points[0][k], first.points[1]), first.directions)
        one = all_configurations(GroupGeometry(many.n, (single, *many.connections[1:]), many.size))
        assert np.nanmax(np.abs(one.turns - found.turns[k])) < 1e-7
        assert np.array_equal(one.real, found.real[k])


def test_unknown_poses_have_no_configuration():
    many = turning("RR,RR,RR", 6)
    first = many.connections[0]
    at = first.points[0].copy()
    at[2] = np.nan
    broken = Connection(first.bodies, (at, first.points[1]))
    found = all_configurations(GroupGeometry(many.n, (broken, *many.connections[1:]), many.size))
    assert found.count.tolist() == [6, 6, 0, 6, 6, 6]
    assert np.isnan(found.states[2]).all()
    unknown = Connection(first.bodies, (np.nan, first.points[1]))
    nothing = all_configurations(GroupGeometry(many.n, (unknown, *many.connections[1:])))
    assert nothing.count == 0


def test_designs_and_poses_keep_their_shape():
    many = turning("RR,RR,RR", 5)
    leg = many.connections[1]
    designs = Connection(leg.bodies, (leg.points[0] * np.linspace(1, 1.1, 3)[:, None], leg.points[1]))
    found = all_configurations(GroupGeometry(many.n, (many.connections[0], designs, *many.connections[2:]), many.size))
    assert found.turns.shape == (3, 5, 6, 4)
    assert found.states.shape[:2] == (3, 5)
    assert found.certified.shape == (3, 5)
    assert found.certified.all()


def test_a_body_that_cannot_reach_has_no_real_configuration():
    apart = GroupGeometry(
        2, (Connection((None, 0), (0, 0)), Connection((0, 1), (1, 0)), Connection((None, 1), (9, 1))), 1.0
    )
    found = all_configurations(apart)
    assert (found.count, found.real_count) == (2, 0)
    assert found.states.shape == (0, 6)
    assert found.certified


def test_the_order_is_by_angles_and_real_first():
    found = all_configurations(random_truss(SMALL[1], np.random.default_rng(8)))
    real = found.real
    assert list(real) == sorted(real, reverse=True)
    angles = found.states[:, 2]
    assert np.all(np.diff(angles) > 0)


def test_wrong_numbers_of_connections_are_told():
    with pytest.raises(InvalidInput, match="do not fix"):
        GroupGeometry(2, (Connection((None, 0), (0, 0)),))
    bodies = [(None, 0), (0, 1), (None, 1), (2, 3), (2, 3), (3, 2)]
    loose = GroupGeometry(4, tuple(Connection(pair, (k, k + 1j)) for k, pair in enumerate(bodies)))
    with pytest.raises(InvalidInput, match="not attached"):
        all_configurations(loose)


def test_an_angle_held_twice_is_told():
    rng = np.random.default_rng(0)
    legs = [(None, 0), (0, 3), (None, 1), (1, 3), (None, 2), (2, 3)]
    connections = tuple(joined(*pair, kind, rng) for pair, kind in zip(legs, "PPPPRR", strict=True))
    with pytest.raises(InvalidInput, match="same angle twice"):
        all_configurations(GroupGeometry(4, connections, 4.0))


def platform(base, corners):
    """Body 3 with its corners at the ends of three legs, drawn at a pose."""
    connections = []
    for k, (foot, corner) in enumerate(zip(base, corners, strict=True)):
        leg = abs(0.7 + 0.4j + np.exp(0.3j) * np.asarray(corner) - foot)
        connections += [Connection((None, k), (foot, 0j)), Connection((k, 3), (leg, corner))]
    return GroupGeometry(4, tuple(connections), 5.0)


def test_a_platform_congruent_with_its_base_has_two_configurations_at_infinity():
    """By eigenvectors and by paths.

    Source: C. M. Gosselin and J.-P. Merlet, The direct kinematics of planar parallel manipulators: special
    architectures and number of solutions, Mech. Mach. Theory 29 (1994) 1083, similar triangles.
    """
    corners = (0j, 4 + 0j, 1 + 3j)
    geometry = platform(corners, corners)
    found = all_configurations(geometry)
    assert (found.count, found.possible) == (4, 6)
    assert not found.certified
    loops = rotation_equations_of(geometry).flat
    assert distinct(polish(loops, homotopy.roots(loops, geometry.graph()))).shape[1] == 4


def test_three_aligned_pins_are_nothing_special():
    found = all_configurations(platform((0, 4, 9), (0, 2, 5)))
    assert found.certified


def test_pins_that_coincide_at_one_pose_only():
    """There the group is two dyads one after the other, with four configurations."""
    feet = np.array([0.3, 3.0, 4.0, 5.2])
    found = all_configurations(platform((feet, 4 + 0j, 1 + 3j), (0j, 2 + 0j, 1 + 1.5j)))
    assert found.count.tolist() == [6, 6, 4, 6]
    assert found.certified.tolist() == [True, True, False, True]


def test_a_body_free_to_turn_is_told():
    """Both pins of a leg at one place: the leg turns freely."""
    drawn = platform((0, 4, 1 + 3j), (0, 2, 1 + 1j))
    first = Connection((0, 3), (0j, 0j))
    with pytest.raises(InvalidInput, match="place the pins"):
        all_configurations(GroupGeometry(4, (drawn.connections[0], first, *drawn.connections[2:]), 5.0))
