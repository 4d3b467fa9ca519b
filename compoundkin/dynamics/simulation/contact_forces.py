"""The forces that press contacts which may let go, from a table over the driver."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.friction.friction_contacts import LoadedContact
from compoundkin.dynamics.reactions.undetermined import spare_force
from compoundkin.dynamics.simulation.drive_table import DRIVE_SCALES, accurate_pieces, piece_at
from compoundkin.dynamics.simulation.driver_state import PushedState, unit_motion
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.normal_force_table import force_layout, usual_sizes
from compoundkin.dynamics.simulation.stop_contacts import holding
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.model.loads.friction import Friction
from compoundkin.model.pairs.contact import as_friction_pair
from compoundkin.model.pairs.profile_contact import as_profile_contact


class ContactForces:
    """The forces that press contacts which may let go: a table over a driver, as of normal forces.

    Where it is not accurate, its rows are those of the solved pose.
    """

    def __init__(self, chart: TabulatedChart, contacts: tuple[LoadedContact, ...]) -> None:
        assert chart.table is not None
        table, motion = chart.table, chart.table.motion
        rubbing = chart.contacts if isinstance(chart, FrictionTable) else ()
        self.layout = force_layout(chart, motion, rubbing, contacts)
        sizes = usual_sizes(self.layout, motion) | dict(table.least)
        self.pieces = accurate_pieces(table.course, self.layout.terms, self.layout.scales, chart.candidates, sizes)
        self.starts = [piece.low for piece in self.pieces]
        self.index = {contact.name: k for k, contact in enumerate(contacts)}

    def pressing(self, name: str, chart: TabulatedChart, time: float, value: float, speed: float) -> float | None:
        """Return the force that presses a contact at a state of a chart, None where it is not known."""
        if name not in self.index:
            return None
        values, speeds = np.array([value]), np.array([speed])
        causes = self._causes(chart, value)
        second, sizes = self._moved(chart, time, values, speeds)
        known = [1.0, second, speed * speed, *sizes]
        if chart.has_others or chart.closed:
            seen = chart.seen(time, values, speeds)
            others = chart.wrenches_of_others(seen.loaded, self.layout.touched)
            if others is None:
                return None
            known += [*others[2:], *self._at_stops(chart, seen, time, values, speeds)]
        normals = np.array(known) @ causes[: len(known)]
        return spare_force(self.index[name], normals, causes[len(causes) - self.layout.states :])

    def _moved(self, chart: TabulatedChart, time: float, values: Number, speeds: Number) -> tuple[float, Number]:
        """Return the acceleration and the frictions; those that act while a rigid stop holds it are not known."""
        if isinstance(chart, FrictionTable) and not chart.rigid:
            found = chart.free_motion(time, values, speeds)
            return found.acceleration, found.sizes
        second = chart.followed_rates(time, values, speeds).accelerations
        return float(second[0]), np.zeros(len(self.layout.contacts))

    def _causes(self, chart: TabulatedChart, value: float) -> Number:
        """Return the normal forces in all contacts by each cause, (causes, contacts)."""
        inside, first = chart.tabulated(value), len(DRIVE_SCALES) + len(self.layout.contacts)
        piece = piece_at(self.pieces, self.starts, inside)
        if piece is not None:
            rows = piece.terms[first:].dot(piece.basis(inside))
        else:
            state = chart.state(0.0, np.array([value]), np.ones(1))
            rows = self.layout.terms(unit_motion(state, chart.start))[first:, 0]
        found: Number = rows.reshape(-1, len(self.index))
        return found

    def _at_stops(
        self, chart: TabulatedChart, seen: PushedState, time: float, values: Number, speeds: Number
    ) -> Number:
        """Return the efforts along the pairs with stops: those of elastic ones may be among the other loads."""
        efforts = dict.fromkeys(self.layout.efforts[len(chart.pushing) :], 0.0)
        rigid = chart.rigid
        if rigid:
            free = chart.unheld_rates(time, values, speeds)
            for one, force in zip(rigid, holding([one.at(seen) for one in rigid], seen, free).tolist(), strict=True):
                efforts[one.stop.pair] += one.side * force
        for one in chart.closed if chart.adds_stops else ():
            if one.stop.is_elastic:
                efforts[one.stop.pair] += one.side * one.push(seen)
        return np.array([*efforts.values()])


def tabulated_pressing(chart: TabulatedChart, name: str, time: float, value: float, speed: float) -> float | None:
    """Return the force that presses a contact, from a table made once; None where it is to be found from the state.

    That is so where the effort of a motor depends on the acceleration, and while a load holds a speed.
    """
    table = chart.table
    if table is None or chart.laws or chart.held is not None or chart.rotors_that_lose:
        return None
    if chart.contact_forces is None or chart.contact_forces[0] is not table:
        pairs = (pair for pair in chart.order.pairs.values()
                 if (own := as_profile_contact(pair)) is not None and not own.has_ends)  # fmt: skip
        contacts = (LoadedContact(one, Friction(one.name, 0.0)) for one in map(as_friction_pair, pairs) if one)
        chart.contact_forces = table, ContactForces(chart, tuple(contacts))
    forces: ContactForces = chart.contact_forces[1]
    return forces.pressing(name, chart, time, value, speed)
