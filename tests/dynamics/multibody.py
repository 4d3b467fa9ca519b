"""A mechanism as a model of MuJoCo, and what multibody dynamics says of it: efforts of drivers, accelerations.

MuJoCo gives the mass matrix, the bias forces and the Jacobians of points and links; its own stepping, whose loops are
soft, is left out. Links are bodies of a spanning tree of pins and slides, the other pairs close loops.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

import compoundkin as ck
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.results import Motion

FRAME = "frame"


def is_of_pins_and_slides(mechanism: ck.Mechanism) -> bool:
    """Whether it has no other pairs."""
    return all(type(pair) in (Revolute, Prismatic) for pair in ck.decompose(mechanism).pairs)


@dataclass
class Multibody:
    """A motion at one pose as a model: joints at zero there."""

    motion: Motion
    index: int

    def __post_init__(self) -> None:
        self.structure = self.motion.structure
        self.poses = {name: pose.entry((0, self.index)) for name, pose in self.motion.poses.items()}
        self.tree = self._tree()
        self.model = mujoco.MjModel.from_xml_string(self._xml())
        self.data = mujoco.MjData(self.model)
        self.joint = {child: self.model.joint(child).dofadr[0] for child in self.tree}
        mujoco.mj_forward(self.model, self.data)

    def _tree(self) -> dict[str, tuple[Pair, str]]:
        """Return pair and parent of every link, those of drivers first."""
        driven = [own.pair for own in self.structure.driven.values()]
        pairs = [*driven, *(pair for pair in self.structure.pairs if pair.name not in {one.name for one in driven})]
        joined = {name: name for name in self.motion.mechanism.links}

        def root(name: str) -> str:
            return name if joined[name] == name else root(joined[name])

        edges = []
        for pair in pairs:
            a, b = (root(name) for name in pair.members)
            if a != b:
                joined[a] = b
                edges.append(pair)
        found: dict[str, tuple[Pair, str]] = {}
        while len(found) < len(self.motion.mechanism.links) - 1:
            known = {FRAME, *found}
            for pair in edges:
                for parent, child in (pair.members, pair.members[::-1]):
                    if parent in known and child not in known:
                        found[child] = (pair, parent)
        return found

    def _xml(self) -> str:
        gravity = complex(self.motion.mechanism.gravity)
        head = f'<mujoco><compiler angle="radian"/><option gravity="{gravity.real!r} {gravity.imag!r} 0"/>'
        return f"{head}<worldbody>{self._bodies(FRAME)}</worldbody></mujoco>"

    def _bodies(self, parent: str) -> str:
        text = ""
        for child, (pair, own) in self.tree.items():
            if own != parent:
                continue
            local = self.poses[parent].inverse().compose(self.poses[child])
            z, angle = complex(local.z.c[0]), float(np.angle(local.u.c[0]))
            mass = self.motion.mechanism.masses[child]
            at = self.motion.mechanism.geometry.points[child][mass.at] if isinstance(mass.at, str) else mass.at
            place, inertia = complex(at), " ".join([repr(float(mass.inertia))] * 3)
            turned = f"{float(np.cos(angle / 2))!r} 0 0 {float(np.sin(angle / 2))!r}"
            text += f'<body name="{child}" pos="{z.real!r} {z.imag!r} 0" quat="{turned}">'
            text += (
                f'<inertial pos="{place.real!r} {place.imag!r} 0" mass="{float(mass.mass)!r}" diaginertia="{inertia}"/>'
            )
            text += f"{self._joint(pair, child)}{self._bodies(child)}</body>"
        return text

    def _joint(self, pair: Pair, child: str) -> str:
        back = self.poses[child].inverse()
        place = complex(back.at(self.place(pair)).c[0])
        if isinstance(pair, Revolute):
            return f'<joint name="{child}" type="hinge" axis="0 0 1" pos="{place.real!r} {place.imag!r} 0"/>'
        along = complex(back.u.c[0]) * self.along(pair)
        return f'<joint name="{child}" type="slide" axis="{along.real!r} {along.imag!r} 0"/>'

    def place(self, pair: Pair) -> complex:
        """Where a pair's point on its second member is."""
        return complex(self.poses[pair.members[1]].at(self._end(pair, 1).point).c[0])

    def along(self, pair: Pair) -> complex:
        """The direction of a slide."""
        return complex(self.poses[pair.members[0]].u.c[0]) * complex(self._end(pair, 0).direction)

    def _end(self, pair: Pair, side: int) -> Any:
        return self.motion.solving_order.ends.get(pair.name, pair.ends(self.motion.mechanism.geometry))[side]

    def jacobian(self, link: str, place: complex, dot: bool = False) -> np.ndarray:
        """Rows x, y and angle of a link's velocity at a place, by the joints; or their time derivatives."""
        moved, turned = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
        if link != FRAME:
            get = mujoco.mj_jacDot if dot else mujoco.mj_jac
            get(self.model, self.data, moved, turned, np.array([place.real, place.imag, 0.0]), self.model.body(link).id)
        return np.vstack([moved[:2], turned[2:]])

    def loops(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the Jacobian of all loops and what their accelerations take, at the speeds that are set."""
        rows, right = [], []
        speeds = self.data.qvel
        in_tree = {pair.name for pair, _ in self.tree.values()}
        for pair in self.structure.pairs:
            if pair.name in in_tree:
                continue
            first, second = pair.members
            place = self.place(pair)
            across, dot = (self.jacobian(second, place, k) - self.jacobian(first, place, k) for k in (False, True))
            if isinstance(pair, Revolute):
                rows += list(across[:2])
                right += list(-dot[:2] @ speeds)
                continue
            e = self.along(pair)
            n = np.array([-e.imag, e.real, 0.0])
            rows += [n @ across, across[2]]
            sliding = np.array([e.real, e.imag, 0.0]) @ across @ speeds
            turning = self.jacobian(first, place)[2] @ speeds
            # the acceleration of Coriolis lies across the guide
            right += [2.0 * turning * sliding - n @ dot @ speeds, -dot[2] @ speeds]
        return np.array(rows).reshape(-1, self.model.nv), np.array(right)

    def drivers(self) -> np.ndarray:
        """Rows that pick the drivers' rates out of those of the joints."""
        rows = np.zeros((len(self.structure.driven), self.model.nv))
        for row, own in zip(rows, self.structure.driven.values(), strict=True):
            child = next(name for name, (pair, _) in self.tree.items() if pair.name == own.pair.name)
            row[self.joint[child]] = own.pair.driven_by(own.drive.link) * (1 if child == own.pair.members[1] else -1)
        return rows

    def move(self, speeds: np.ndarray) -> None:
        """Set the speeds of the drivers, and those of all joints that go with them."""
        rows = np.vstack([self.loops()[0], self.drivers()])
        self.data.qvel[:] = np.linalg.lstsq(rows, np.append(np.zeros(len(rows) - len(speeds)), speeds), rcond=None)[0]
        mujoco.mj_forward(self.model, self.data)

    @property
    def mass_matrix(self) -> np.ndarray:
        """The mass matrix by the joints."""
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full

    def efforts(self, accelerations: np.ndarray) -> np.ndarray:
        """Return what the drivers must do for accelerations of theirs."""
        rows, right = self.loops()
        held = np.vstack([rows, self.drivers()])
        second = np.linalg.lstsq(held, np.append(right, accelerations), rcond=None)[0]
        push = self.mass_matrix @ second + self.data.qfrc_bias
        found: np.ndarray = np.linalg.lstsq(held.T, push, rcond=None)[0][len(rows) :]
        return found

    def accelerations(self) -> np.ndarray:
        """Return the accelerations of drivers that are free."""
        rows, right = self.loops()
        zero = np.zeros((len(rows), len(rows)))
        matrix = np.block([[self.mass_matrix, -rows.T], [rows, zero]])
        second = np.linalg.lstsq(matrix, np.append(-self.data.qfrc_bias, right), rcond=None)[0][: self.model.nv]
        found: np.ndarray = self.drivers() @ second
        return found
