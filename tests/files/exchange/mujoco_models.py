"""Models of mechanisms run by MuJoCo: coordinates of joints at solved poses, speeds, efforts of drivers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mujoco
import numpy as np

from compoundkin.files.exchange.contract import Exported
from compoundkin.files.exchange.mjcf.mjcf_format import FORMAT
from compoundkin.files.exchange.mjcf.model_plan import units_of
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.units import FORCES, LENGTHS
from compoundkin.results import Motion

# How far apart poses are between which the Jacobian's rate is taken, in time at speeds of about one.
_STEP = 1e-5
_PLANE = np.array([1.0, 1j, 0.0])


@dataclass
class MujocoModel:
    """The model of a mechanism: of how it was written, nothing but the names of bodies and points is used."""

    shown: PosedMechanism

    def __post_init__(self) -> None:
        self.exported: Exported = FORMAT.write(self.shown)
        self.model = mujoco.MjModel.from_xml_string(self.exported.text)
        self.data = mujoco.MjData(self.model)
        self.length = units_of(self.shown.mechanism).length
        mujoco.mj_forward(self.model, self.data)
        self.anchors, self.axes = self.data.xanchor @ _PLANE, self.data.xaxis @ _PLANE

    def _moved(self, motion: Motion, name: str) -> tuple[Any, Any]:
        """How the space of a body has turned about 0 and shifted since it was drawn, over the poses."""
        link = name.split(" at ")[0]
        if name == "world":
            return np.zeros(motion.shape), np.zeros(motion.shape, complex)
        start, angle = self.shown.poses[link], motion.links[link].angle
        # counted from the turn that is nearest to the drawn one
        turned = angle - start.angle.c[0]
        turned = turned - 2 * np.pi * np.round(turned[self._nearest(motion)] / (2 * np.pi))
        now = np.broadcast_to(motion.poses[link].z.c[0], (1, *motion.shape))[0]
        return turned, (now - np.exp(1j * turned) * start.z.c[0]) * self.length

    def _nearest(self, motion: Motion) -> int:
        """The pose nearest to that as drawn, by the drivers."""
        off = sum(np.abs(np.broadcast_to(own.value, motion.shape) - self.shown.values[name])
                  for name, own in motion.drives.items())  # fmt: skip
        return int(np.argmin(np.where(motion.assembled, off, np.inf)))

    def qpos(self, motion: Motion) -> np.ndarray:
        """The joints' coordinates at all poses of a motion, by what links do and not by the writer's chains."""
        found = np.zeros((*motion.shape, self.model.nq))
        for body in range(1, self.model.nbody):
            first, count = self.model.body_jntadr[body], self.model.body_jntnum[body]
            parent = self.model.body(self.model.body_parentid[body]).name
            turned, shift = self._moved(motion, self.model.body(body).name)
            before, carried = self._moved(motion, parent)
            joints = np.arange(first, first + count)
            found[..., joints] = self._coordinates(joints, turned - before, (shift - carried) * np.exp(-1j * before))
        return found

    def _coordinates(self, joints: np.ndarray, angle: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Coordinates of a body's joints whose product turns by `angle` about 0 and shifts by `way`."""
        hinges = self.model.jnt_type[joints] == 3
        out = np.zeros((*angle.shape, len(joints)))
        if hinges.sum() == 2:
            one, two = self.anchors[joints]
            out[..., 0] = np.unwrap(np.angle((np.exp(1j * angle) * two + way - one) / (two - one)))
            out[..., 1] = angle - out[..., 0]
            return out
        moved = way
        if hinges.any():
            (place,) = self.anchors[joints][hinges]
            moved = np.exp(1j * angle) * place + way - place
            # slides that turn with the hinge before them
            moved = moved if hinges[-1] else place - np.exp(-1j * angle) * (place - way)
        for k, joint in enumerate(joints):
            out[..., k] = angle if hinges[k] else (np.conj(self.axes[joint]) * moved).real
        return out

    def place(self, qpos: np.ndarray, qvel: np.ndarray | None = None) -> None:
        """Set coordinates and speeds, and compute all that follows from them."""
        self.data.qpos[:] = qpos
        self.data.qvel[:] = 0.0 if qvel is None else qvel
        mujoco.mj_forward(self.model, self.data)

    @property
    def gap(self) -> float:
        """By how much the constraints are open: metres, radians."""
        return float(np.max(np.abs(self.data.efc_pos[: self.data.ne]), initial=0.0))

    @property
    def loops(self) -> np.ndarray:
        """The Jacobian of all constraints."""
        return np.array(self.data.efc_J).reshape(-1, self.model.nv)[: self.data.ne]

    @cached_property
    def sites(self) -> list[tuple[str, int]]:
        """The letters of all points, each with one of its sites; a pin has as many as links."""
        named = [(self.model.site(k).name.partition(" on ")[0], k) for k in range(self.model.nsite)]
        return [(letter, k) for letter, k in named if letter in self.shown.mechanism.carriers]

    @property
    def places(self) -> np.ndarray:
        """Where all points are."""
        return (self.data.site_xpos @ _PLANE)[[k for _, k in self.sites]]

    def velocities(self, qvel: np.ndarray) -> np.ndarray:
        """The velocities of all points by their Jacobians."""
        rows = np.zeros((len(self.sites), 3, self.model.nv))
        for (_, k), own in zip(self.sites, rows, strict=True):
            mujoco.mj_jacSite(self.model, self.data, own, None, k)
        return _PLANE @ (rows @ qvel).T

    @cached_property
    def joints(self) -> np.ndarray:
        """The drivers' joints."""
        found: np.ndarray = self.model.actuator_trnid[: len(self.shown.structure.driven), 0]
        return found

    @cached_property
    def signs(self) -> np.ndarray:
        """1 for drivers whose joints move as they do, -1 where it is the other way round."""
        model, links = self.model, self.shown.structure.driven.values()
        bodies = [model.body(model.jnt_bodyid[joint]).name.split(" at ")[0] for joint in self.joints]
        return np.array([1.0 if one.drive.link == body else -1.0 for one, body in zip(links, bodies, strict=True)])

    @cached_property
    def effort_units(self) -> np.ndarray:
        """The drivers' units of effort in newtons, or newton metres."""
        units = self.shown.mechanism.stated_units
        force = FORCES[units.force]
        return np.where(self.model.jnt_type[self.joints] == 3, force * LENGTHS[units.length], force)

    def rates(self, motion: Motion, which: str = "rate") -> np.ndarray:
        """The rates of the drivers' joints, or their second rates: an array (poses, drivers)."""
        given = [np.broadcast_to(getattr(motion.drives[name], which), motion.shape) for name in motion.drives]
        scales = np.where(self.model.jnt_type[self.joints] == 3, 1.0, self.length)
        rates: np.ndarray = np.transpose(given) * scales * self.signs
        return rates

    def speeds(self, rates: np.ndarray) -> np.ndarray:
        """The speeds of all joints for those of the drivers' joints."""
        held = np.vstack([self.loops, np.eye(self.model.nv)[self.joints]])
        found: np.ndarray = np.linalg.lstsq(held, np.append(np.zeros(len(self.loops)), rates), rcond=None)[0]
        return found

    def _pull_of_loads(self) -> np.ndarray:
        """What the actuators of loads do, without those of drivers."""
        count = len(self.joints)
        moment = np.zeros((self.model.nu, self.model.nv))
        mujoco.mju_sparse2dense(
            moment, self.data.actuator_moment, self.data.moment_rownnz, self.data.moment_rowadr, self.data.moment_colind
        )
        pull: np.ndarray = moment[count:].sum(axis=0)
        return pull

    def efforts(self, qpos: np.ndarray, rates: np.ndarray, accelerations: np.ndarray) -> np.ndarray:
        """What drivers must do, by the mass matrix, the bias, and the Jacobian of the loops and its rate."""
        self.place(qpos)
        speeds = self.speeds(rates)
        step = _STEP / np.abs(speeds).max()
        self.place(qpos - step * speeds)
        before = self.loops
        self.place(qpos + step * speeds)
        rate = (self.loops - before) / (2.0 * step)
        self.place(qpos, speeds)
        held = np.vstack([self.loops, np.eye(self.model.nv)[self.joints]])
        second = np.linalg.lstsq(held, np.append(-rate @ speeds, accelerations), rcond=None)[0]
        matrix = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, matrix)
        push = matrix @ second + self.data.qfrc_bias - self.data.qfrc_passive - self._pull_of_loads()
        found: np.ndarray = np.linalg.lstsq(held.T, push, rcond=None)[0][len(self.loops) :]
        return found
