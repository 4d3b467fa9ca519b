"""Forces by name: in pairs, at pins, of drivers, on links, on the frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from compoundkin.base.display import DisplaysHtml, DisplaysText
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.friction.efficiency import Efficiency
from compoundkin.dynamics.reactions.driver_efforts import DriverEffort, Powers, powers_of
from compoundkin.dynamics.reactions.link_forces import LinkForces, PinForces, ShakingForce, link_forces
from compoundkin.dynamics.reactions.pair_forces import PairForce
from compoundkin.dynamics.reactions.undetermined import Undetermined, undetermined_forces
from compoundkin.kinematics.motion import Motion, Named
from compoundkin.kinematics.quantities import Table, table_of
from compoundkin.model.attributes import FORCE, FORCES, MOMENT

if TYPE_CHECKING:
    from compoundkin.kinematics.finding import Check


@dataclass(frozen=True, repr=False)
class Forces(DisplaysHtml, DisplaysText, ForceResult):
    """The forces of a motion, in the mechanism's units.

    Arrays have the motion's shape, and are NaN where poses are not assembled.
    """

    without_friction: Forces | None = None

    @property
    def frictionless(self) -> Forces:
        """The forces of the same motion without friction."""
        return self if self.without_friction is None else self.without_friction

    @cached_property
    def efficiency(self) -> Efficiency:
        """How much of the power put in comes out, and whether it is self-locking."""
        efforts = {name: self.frictionless.drives[name].effort for name in self.friction.intervals}
        return Efficiency(self.motion, self.power, self.friction, efforts)

    @cached_property
    def pairs(self) -> Mapping[str, PairForce]:
        """The force in every pair by its name."""
        return Named("pair", tuple(self.wrenches), lambda name: PairForce(self, self.solving_order.pairs[name]))

    @cached_property
    def pins(self) -> Mapping[str, PinForces]:
        """The forces of every pin on its links, by its letter."""
        return Named("pin", tuple(self.mechanism.real_pins), lambda letter: PinForces(self, letter))

    @cached_property
    def drives(self) -> Mapping[str, DriverEffort]:
        """The effort of every driver by its name."""
        driven = self.motion.structure.driven
        return Named("driver", tuple(driven), lambda name: DriverEffort(self, driven[name]))

    def table(self, *names: str) -> Table:
        """Return quantities of forces and of their motion as columns.

        Designs, time and drivers stand beside them. Without names those are the efforts and powers of drivers, the
        forces and moments in pairs. Raises UnknownName.
        """
        return table_of(self.motion, *(names or self._names))

    def to_pandas(self, *names: str) -> Any:
        """Return the table of these quantities as a pandas DataFrame."""
        return self.table(*names).to_pandas()

    @property
    def _names(self) -> list[str]:
        """What a whole table has."""
        words = dict.fromkeys(self.drives, FORCES["drives"]) | dict.fromkeys(self.pairs, (FORCE, MOMENT))
        return [f"{name}.{word}" for name, own in words.items() for word in own]

    @cached_property
    def undetermined(self) -> tuple[Undetermined, ...]:
        """Parts that equilibrium does not determine, NaN in pairs and pins.

        None unless the mechanism is overconstrained.

        >>> from compoundkin.files import load
        >>> from compoundkin.dynamics.force_analysis import force_analysis
        >>> from compoundkin.kinematics import solve
        >>> units = {"length": "mm", "mass": "kg", "force": "N"}
        >>> held = load("parallelogram-third-crank").replace(unit="", units=units)
        >>> forces = force_analysis(solve(held, {"crank": [1.0]}))
        >>> print(forces.undetermined[0])
        A: the force along A B of crank, balanced by forces in D, F, B, C, E
        """
        return undetermined_forces(self)

    @property
    def assuming_freed(self) -> Forces:
        """The forces under an assumption that makes all determined.

        It is that the parts of pairs which `relaxed` names are free.
        """
        return replace(self, assumed=True)

    @cached_property
    def power(self) -> Powers:
        """The power of all that acts, and the energies. Raises InvalidInput for a motion without velocities."""
        return powers_of(self)

    def check(self) -> Check:
        """Return the findings of an independent verification, which is `verify(forces)`."""
        from compoundkin.dynamics.reactions.force_check import check_forces

        return check_forces(self)

    @cached_property
    def shaking(self) -> ShakingForce:
        """The force of the mechanism on its frame."""
        return ShakingForce(self)

    def on(self, link: str) -> LinkForces:
        """Return all that acts on a link, its free body. Raises UnknownName for an unknown link.

        >>> from compoundkin.model.elements import drive, link
        >>> from compoundkin.model.loads.gravity import gravity
        >>> from compoundkin.model.loads.mass import mass
        >>> from compoundkin.model.mechanism import Mechanism
        >>> from compoundkin.dynamics.force_analysis import force_analysis
        >>> from compoundkin.kinematics import solve
        >>> items = link("frame", A=0), link("crank", A=0, B=2), drive("crank"), mass("crank", 1.0, at="B")
        >>> units = {"length": "m", "mass": "kg", "force": "N"}
        >>> crank = Mechanism("m", *items, gravity(0, -9.81), units=units)
        >>> force_analysis(solve(crank, {"crank": [0.0]}, speed=3.0)).on("crank")
        LinkForces(crank: pair A, driver crank, weight crank, inertia crank)
        """
        known = self.mechanism.links
        if link not in known:
            raise UnknownName(Problem(str(link), "there is no such link", suggestion(str(link), list(known))))
        if link not in self._on:
            self._on[link] = link_forces(self, link)
        return self._on[link]

    @cached_property
    def _on(self) -> dict[str, LinkForces]:
        return {}

    def __repr__(self) -> str:
        kind = "with" if self.inertia else "without"
        if not (self.mechanism.masses or self.mechanism.loads):
            kind = f"no masses and no loads, {kind}"
        missing = f", {count} not assembled" if (count := int((self.motion.failed != 0).sum())) else ""
        missing += f", {len(self.singular)} singular" if self.singular else ""
        if self.assumed:
            kind = f"assuming freed {', '.join(map(str, self.relaxed))}, {kind}"
        text = f"{kind} inertia: {len(self.wrenches)} pairs at {self.shape} poses{missing}"
        return f"Forces({self.mechanism.title!r} {text})"


def motion_of(what: Motion | Forces) -> Motion:
    """Return the motion of forces, a motion itself. Both have quantities of forces by name."""
    return what.motion if isinstance(what, Forces) else what
