"""Wrong objects given to every public function: only the package's own errors answer, each with its place."""

from __future__ import annotations

import datetime
import inspect
import math
import os
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests.catalog import mechanism as loaded

GIVEN = dict[str, Any]
FIVE_POSES = [(0, 0, 0), (1, 0.1, 0.3), (2, 0.4, 0.5), (2.5, 1, 0.9), (3, 2, 1)]


@cache
def at_hand() -> dict[str, Any]:
    """What the calls below are given, made once."""
    bar, cam = loaded("crank-rocker"), loaded("disc-cam-offset-roller")
    rocker = ck.solve(bar, {"crank": ck.deg([10, 20, 30])}, order=3)
    upper, fore = ck.link("upper", A=0, B=2), ck.link("fore", B=0, P=1)
    arm = ck.Mechanism("arm", ck.link("frame", A=0), upper, fore, ck.drive("upper"), ck.drive("fore", on="upper"))
    heavy = arm.replace(ck.mass("fore", 2.0, at=(0.5, 0)), units={"length": "m", "mass": "kg", "force": "N"})
    turned = bar.replace(ck.mass("crank", 2.0, at="B"), ck.gravity(0, -9.81), unit="", units=heavy.units)
    balancer = ck.spring("rocker", "C", at="A", stiffness=1.0, name="balancer")
    return {
        "forces": ck.force_analysis(ck.solve(turned, ck.deg(range(0, 361, 30)), speed=2)),
        "sprung": ck.force_analysis(ck.solve(turned.replace(balancer), ck.deg(range(0, 361, 30)))),
        "arm": arm,
        "solved": ck.synthesise(ck.tasks.poses("plate", FIVE_POSES[:3]), ground=[(-1, -2), (3, -2)])[0],
        "coupled": bar.replace(ck.link("coupler", B=0, C=5, P=(2, 1.5))),
        "heavy": heavy,
        "moved": ck.solve(heavy, {"upper": [0.1, 0.2], "fore": [1.0, 1.1]}),
        "region": ck.figures.workspace(arm, "P", cells=8),
        "bar": bar,
        "structure": ck.decompose(bar),
        "studied": ck.study(bar, {"crank.B.x": (0.9, 1.1)}, "rocker.angle.stroke", count=4).run(),
        "optimum": ck.optimise(bar, {"rocker.C.x": (3.5, 4.5)}, "rocker.angle.stroke", starts=1),
        "tolerances": ck.tolerance(arm, {"fore.P.x": 0.1}, "P.x", values={"upper": 0.1, "fore": [1.0, 1.1]}, count=800),
        "motion": rocker,
        "timed": ck.solve(loaded("five-bar-led"), time=[0.0, 0.1, 0.2]),
        "cam": ck.solve(cam),
        "loaded": ck.solve(
            arm.replace(units={"length": "m", "mass": "kg", "force": "N"}), {"upper": [1.0], "fore": 1.0}
        ),
        "outlined": ck.solve(bar.replace(ck.outline("crank", 0.1))),
        "chain": ck.chains.chains(6)[0],
        "group": ck.chains.assur_groups(2)[0],
        "place": ck.figures.LinkPosition((0, 0), 1.0),
        "line": ck.equations.MovingLine((0, 0), 1.0),
        "joints": ck.chains.Joints(("a", "b", "c"), (ck.chains.Joint((0, 1)), ck.chains.Joint((1, 2)))),
        "loop": ck.loop_equations(bar).loops[0],
        "program": ck.laws.program(ck.laws.rise(1, over=2)),
        "wave": ck.laws.program(ck.laws.rise(1, over=math.pi), ck.laws.fall(1, over=math.pi)),
    }


class Hidden:
    """An object of nobody's."""


# What is given in the place of each argument.
WRONG: tuple[Any, ...] = (
    None, 3, -1, 10**400, 2.5, math.nan, math.inf, True, 1j, "x", "", "\ud800", b"x", [], [3], ["x"], [None], {},
    {1: 1}, {"x": "y"}, {"crank": "x"}, {"crank": None}, set(), (1, 2, 3), (1, "x"), object(), Hidden, Hidden(), abs,
    ck,
    np.array(["x"]), np.array(["x", "y"]), np.array([]), np.zeros((2, 0, 3)), np.array([object()]), np.array([1j]),
    np.ma.array([1.0, 2.0], mask=[True, False]), np.datetime64("2026-01-01"), datetime.date(2026, 1, 1),
    np.timedelta64(3, "s"),     [[1.0], [1.0, 2.0]], range(0), iter(()),
)  # fmt: skip


@cache
def calls() -> dict[str, tuple[Callable[..., Any], GIVEN]]:
    """Every public function, with arguments that are right."""
    h = at_hand()
    m, motion, chain = h["bar"], h["motion"], h["chain"]
    on = {"motion": motion, "link": "coupler"}
    at = {**on, "point": "C"}
    found: dict[str, GIVEN] = {
        "Mechanism": {"title": "m", "unit": "", "source": "", "description": "", "outputs": (), "time": None},
        "alternatives": {"mechanism": m, "frames": ("crank",)},
        "animate": {"what": motion, "design": 0, "paths": (), "vectors": (), "centres": False, "labels": True,
                    "seconds": 1.0, "fps": 10.0, "back": None, "size": None},
        "arc": {"link": "a", "on": "b", "at": "A", "centre_at": "B", "radius": 1.0, "name": "n"},
        "around": {"centre": (1.0, 2.0), "within": 0.1, "sigmas": 3.0},
        "belt": {"first": "a", "second": "b", "radii": (1.0, 2.0), "name": "n", "carrier": "frame", "teeth": None,
                 "phase": None, "first_at": "A", "second_at": "B", "crossed": False},
        "cam": {"link": "a", "on": "b", "at": "A", "profile": ck.profiles.disc(1), "radius": 0.0, "inside": False},
        "characteristics": {"motion": motion, "outputs": (), "design": 0, "dwell": 0.01, "straight": 0.001},
        "circuits": {"mechanism": m, "driver": "crank", "values": None, "between": None, "design": 0},
        "cognates": {"mechanism": h["coupled"], "point": "P"},
        "coupler_atlas": {"links": 4, "count": 500, "seed": 0, "folder": None},
        "compile": {"mechanism": m, "outputs": ["C"], "free": ["figures.C"], "values": None, "modes": None,
                    "hint": None, "backend": "numpy"},
        "configurations": {"mechanism": m, "values": {"crank": 1.0}},
        "cylinder": {"link": "a", "point": "A", "to": "b", "at": "B", "stroke": None, "name": "n"},
        "damper": {"link": "a", "point": "A", "to": "frame", "at": "S", "pair": "", "rate": 4.0, "name": "n"},
        "decompose": {"mechanism": m},
        "deg": {"angle": 3.0},
        "draw": {"what": motion, "at": None, "kind": "sketch", "pose": 0, "design": 0, "ghosts": 0, "paths": (),
                 "centres": False, "vectors": (), "labels": True, "size": None, "link": None},
        "drawn": {"A": 0},
        "drive": {"link": "a", "on": "frame", "pair": "", "values": 0.0, "speed": 1.0, "acceleration": 0.0,
                  "jerk": 0.0, "law": None, "name": "n"},
        "effort": {"pair": "stroke", "amount": 3.0, "only": "back", "name": "n"},
        "expect": {"quantity": "a.angle", "value": 0.5, "tolerance": 1e-3, "crank": 1.0},
        "dyads": {"poses": FIVE_POSES, "velocities": None, "accelerations": None},
        "face": {"link": "a", "on": "b", "at": "A", "profile": ck.profiles.disc(1), "angle": 0.0, "side": 1},
        "force": {"link": "a", "force": (1, 2), "at": "A", "fixed_in": "frame", "while_moving": (1, 0), "name": "n"},
        "force_analysis": {"motion": h["loaded"], "inertia": True, "holding": ""},
        "friction": {"pair": "A", "coefficient": 0.1, "radius": 2.0, "length": None},
        "gaps": {"motion": motion},
        "singularities": {"what": motion, "outputs": ()},
        "gear": {"first": "a", "second": "b", "radii": (1.0, 2.0), "name": "n", "carrier": "frame", "teeth": None,
                 "phase": None, "first_at": "A", "second_at": "B", "internal": False, "module": None},
        "gravity": {"x": 0.0, "y": -9.81, "unit": "m/s^2"},
        "instant_centres": {"motion": motion},
        "latch": {"pair": "A", "at": 0.0, "since": None, "teeth": None, "strength": 2.0, "until": 1.0, "over": "crank",
                  "value": 1.0, "name": "n"},
        "link": {"name": "a", "A": 0},
        "interference": {"motion": h["outlined"]},
        "load": {"path": "six-bar"},
        "loop_equations": {"mechanism": m, "order": 2},
        "mass": {"link": "a", "mass": 1.0, "at": "A", "inertia": 0.1, "density": None},
        "mobility_analysis": {"mechanism": m, "poses": None},
        "mode": {"sign": 1},
        "outline": {"link": "a", "width": 8.0, "through": (), "at": None, "radius": None, "polygon": (), "pin": 5.0,
                    "layer": 0, "name": ""},
        "optimise": {"mechanism": m, "free": {"coupler.C.x": (4.9, 5.1)},
                     "objective": ck.goals.path("C", [(4, 3), (3, 3), (2, 2)]), "subject_to": (),
                     "values": ck.deg([0, 90, 180]), "speed": 1.0, "acceleration": 0.0, "jerk": 0.0,
                     "time": None, "modes": None, "starts": 1, "atlas": None, "seed": 0, "method": None,
                     "progress": None},
        "page": {"what": motion, "outputs": (), "design": 0},
        "plot": {"motion": motion, "against": None, "stacked": True, "extremes": None, "designs": (), "xlim": None,
                 "ylim": (0, 9), "log": None, "title": None, "size": None},
        "polar": {"radius": 1.0, "angle": 1.0},
        "pretension": {"pair": "belt", "force": 10.0},
        "quantity": {"motion": motion, "name": "C.x"},
        "rack": {"rack": "a", "pinion": "b", "name": "n", "through": "A", "at": "B", "angle": 0.0, "toward": None,
                 "radius": 1.0, "teeth": None, "module": None, "side": 1, "phase": None},
        "release": {"pair": "A", "strength": 2.0, "until": 1.0, "over": "crank", "value": 1.0, "name": "n"},
        "report": {"what": motion, "outputs": (), "design": 0},
        "roll": {"link": "a", "on": "b", "through": "A", "at": "B", "angle": 0.0, "toward": None, "radius": 1.0,
                 "side": 1, "phase": None, "name": "n"},
        "roll_around": {"link": "a", "on": "b", "centre_at": "A", "at": "B", "circle": 3.0, "radius": 1.0,
                        "inside": False, "phase": None, "name": "n"},
        "save": {"what": motion, "path": os.devnull + "/x.csv"},
        "exercise": {"mechanism": h["bar"], "vary": 0.1, "seed": 0, "count": 1, "questions": "mobility"},
        "sheet": {"forces": h["forces"], "at": None, "pose": 1, "design": 0},
        "simulate": {"mechanism": h["heavy"], "start": {"upper": (0.1, 0.2)}, "until": 0.1, "prescribed": {"fore": 1.0},
                     "events": {}, "stop": (), "restitution": None,
                     "times": None, "tolerance": 1e-6, "modes": None, "progress": None},
        "studio": {"mechanism": h["bar"]},
        "slide": {"link": "a", "on": "b", "at": "A", "through": "B", "angle": 0.0, "toward": None, "offset": None,
                  "turn": None, "name": "n"},
        "slot": {"link": "a", "on": "b", "at": "A", "through": "B", "angle": 0.0, "toward": None, "offset": 0.0,
                 "name": "n"},
        "solve": {"mechanism": m, "values": {"crank": 1.0}, "time": None, "speed": 1.0, "acceleration": 0.0,
                  "jerk": 0.0, "order": 2, "modes": None, "hint": None},
        "spring": {"link": "a", "point": "A", "to": "frame", "at": "S", "pair": "", "stiffness": 4.0,
                   "free_length": 1.0, "free": 0.0, "preload": 0.0, "only": "tension", "name": "n"},
        "pressure": {"pair": "slide", "pressure": 2.0, "bore": 5.0, "area": None, "rod": 1.0, "back": 0.0, "name": ""},
        "motor": {"pair": "A", "stall": 2.0, "no_load": 100.0, "breakdown": None, "synchronous": None, "slip": None,
                  "torque": None, "speed": None, "gain": None, "limit": 1.0, "power": 1.0, "gear": 1.0,
                  "efficiency": 1.0, "inertia": 0.0, "name": ""},
        "stop": {"pair": "A", "low": -1.0, "high": 1.0, "restitution": 0.5, "stiffness": None, "damping": None,
                 "name": "n"},
        "study": {"mechanism": m, "dimensions": {"crank.B.x": (0.9, 1.1)}, "outputs": ["C"], "sample": "sobol",
                  "count": 2, "seed": 1, "values": None, "speed": None, "acceleration": None, "jerk": None,
                  "time": None, "modes": None, "given": None},
        "synthesise": {"task": ck.tasks.poses("plate", FIVE_POSES[:4]), "region": None, "lengths": (0.1, 9.0),
                       "ground": [(-1, -2), (3, -2)], "transmission": 0.0, "turning": False, "prefer": "transmission"},
        "tolerance": {"mechanism": h["arm"], "tolerances": {"fore.P.x": 0.1}, "outputs": "P.x", "clearance": {"B": 0.1},
                      "values": {"upper": 1.0, "fore": 1.0}, "speed": None, "acceleration": None, "jerk": None,
                      "time": None, "modes": None, "count": 800, "seed": 0, "sigmas": 3.0,
                      "percentiles": (1, 50)},
        "torque": {"link": "a", "torque": 3.0, "name": "n"},
        "verify": {"motion": motion},
        "with_dimensions": {"mechanism": m, "dimensions": {"crank.B.x": 1.0}},
        "with_driver": {"mechanism": m, "link": "rocker", "on": "frame", "pair": "", "instead": "crank", "speed": 1.0,
                        "values": None},
        "with_frame": {"mechanism": m, "link": "crank"},
        "figures.workspace": {"mechanism": h["arm"], "point": "P", "ranges": None, "orientation": None,
                                  "modes": None, "cells": 8},
        "figures.intermittent_motion": {"mechanism": ck.load("geneva-wheel"), "values": None, "pair": "slot",
                                        "slots": 4, "speed": 1.0, "acceleration": 0.0, "order": 2},
        "figures.sizing": {"forces": h["forces"], "motors": None, "driver": None, "gear": 2.0, "efficiency": 0.9,
                           "design": 0},
        "figures.ForcePort": {"link": "a", "point": "C", "angle": 0.0, "on": "frame"},
        "figures.TorquePort": {"link": "a", "on": "frame"},
        "figures.mechanical_advantage": {"motion": motion, "output": "rocker", "input": "crank"},
        "figures.cam_analysis": {"motion": h["cam"], "name": "roller/cam"},
        "profiles.cam_mechanism": {"cams": ck.profiles.constant_breadth(h["wave"], base=20.0), "title": "", "unit": ""},
        "profiles.cam_pairs": {"motion": h["cam"]},
        "figures.four_bar_code": {"base": 2.0, "input": 1.0, "coupler": 2.5, "output": 2.5},
        "figures.path_features": {"motion": motion, "point": "C", "tolerance": None, "design": 0},
        "figures.straightness": {"motion": motion, "point": "C", "begin": 0.2, "end": 0.5, "design": 0},
        "figures.linkage_types": {"what": m, "design": 0},
        "chains.Chain": {"links": 4, "pairs": ((0, 1), (1, 2), (2, 3), (0, 3))},
        "chains.Chain.of": {"links": 4, "pairs": ((0, 1), (1, 2), (2, 3), (0, 3))},
        "chains.Chain.from_code": {"code": "Bw"},
        "chains.Coloured": {"colours": ("a",), "masks": (0,)},
        "chains.Joint": {"links": (0, 1), "code": "R", "held": 2, "guide": None, "kind": ""},
        "chains.Joints": {"links": ("a", "b"), "joints": (ck.chains.Joint((0, 1)),)},
        "chains.assur_group": {"name": "RRR", "also": ()},
        "chains.assur_groups": {"links": 2},
        "chains.canonical": {"graph": ck.chains.Coloured(("a",), (0,))},
        "chains.chain_name": {"chain": chain, "frame": 0},
        "chains.chains": {"links": 6, "mobility": 1},
        "chains.chains_of": {"links": 6, "mobility": 1, "bridged": False},
        "chains.group_name": {"group": h["group"]},
        "chains.group_truss": {"group": h["structure"].groups[0]},
        "chains.inversions": {"links": 6, "mobility": 1},
        "chains.mechanism_from": {"chain": chain, "frame": 0, "title": ""},
        "chains.name_of": {"graph": h["structure"].graph, "frame": "frame", "driver": "crank"},
        "chains.named": {"joints": h["joints"], "frame": "a", "driver": "b"},
        "chains.number_of": {"chain": chain},
        "chains.structure_name": {"structure": h["structure"]},
        "chains.symmetric_drivers": {"chain": chain, "frame": 0},
        "chains.trusses": {"links": 5},
        "chains.Composer": {"title": "m"},
        "chains.random_mechanism": {"groups": 2, "seed": 1, "kinds": ("RRR",), "multiple": 0.1},
        **{f"figures.{name}": on for name in ("acceleration_pole", "canonical_frame", "centrode_curvature", "centrodes",
           "inflection_circle", "pole", "pole_velocity", "relative_link", "stationary_curvature", "tangential_circle")},
        **{f"figures.{name}": at for name in ("curvature_rate", "euler_savary", "path_curvature", "relative_point")},
        "figures.LinkPosition": {"point": (0, 0), "angle": 1.0},
        "figures.displacement": {"first": h["place"], "second": h["place"]},
        "figures.link_position": {**on, "at": 0, "on": "frame"},
        "figures.pole_triangle": {"first": h["place"], "second": h["place"], "third": h["place"]},
        "equations.MovingLine": {"point": (0, 0), "angle": 1.0, "angular_velocity": 1.0, "angular_acceleration": 1.0},
        "equations.MovingPoint": {"position": 1j, "velocity": 1j, "acceleration": 1j},
        "equations.line_through": {"a": (0, 0), "b": (1, 0)},
        "equations.link": {"line": h["line"], "along": 1.0, "across": 0.0},
        "equations.prp": {"first": h["line"], "second": h["line"], "first_offset": 0.0, "second_offset": 0.0},
        "equations.rpp": {"a": (1, 2), "guide": h["line"], "angle": 1.0, "offset": 0.0},
        "equations.rpr": {"a": (0, 0), "b": (2, 0), "offset": 0.0, "mode": 1},
        "equations.rrp": {"a": (0, 0), "guide": h["line"], "length": 2.0, "offset": 0.0, "mode": 1},
        "equations.rrr": {"a": (0, 0), "b": (2, 0), "first_length": 2.0, "second_length": 2.0, "mode": 1},
        "equations.freudenstein": {"mechanism": m},
        "equations.latex": {"equation": h["loop"]},
        "equations.newton_iterations": {"mechanism": m, "values": {"crank": 1.0}, "start": None},
        "equations.text": {"equation": h["loop"]},
        "figures.equivalent_linkage": {"motion": h["cam"], "at": 0},
        "exchange.compare": {"one": m, "other": m},
        "exchange.from_pylinkage": {"mechanism": None},
        "exchange.read": {"source": "crank,ground,R,0,0\ncrank,R,1,0", "form": "pmks"},
        "exchange.write": {"mechanism": m, "form": "pmks", "at": {"crank": 1.0}},
        "goals.assembles": {"margin": 0.05},
        "goals.at_least": {"name": "rocker.angle", "value": 0.5},
        "goals.at_most": {"name": "rocker.angle", "value": 0.5},
        "goals.box": {"point": "C", "x": (0.0, 5.0), "y": None},
        "goals.clearance": {"at_least": 1.0, "one": "crank", "other": None},
        "goals.distance": {"one": "A", "other": "D", "at_least": 1.0, "at_most": 9.0},
        "goals.dwell": {"output": "rocker.angle", "between": (0.1, 0.5), "driver": None},
        "goals.even": {"output": "rocker.angle"},
        "goals.full_turn": {"driver": None, "margin": 0.05},
        "goals.function": {"output": "rocker.angle", "wanted": [(0, 1)], "driver": None, "free_zero": False},
        "goals.greatest": {"name": "rocker.angle.stroke"},
        "goals.without_harmonics": {"output": "frame.shaking_force", "orders": [1, 2]},
        "goals.least": {"name": "rocker.angle.stroke"},
        "goals.path": {"point": "C", "through": [(1, 2), (3, 4)]},
        "goals.poses": {"link": "coupler", "point": "C", "wanted": [(1, 2, 0.3)], "arm": None, "timed": True,
                        "driver": None},
        "goals.straight_line": {"point": "C", "between": (0.1, 0.5), "angle": None, "driver": None},
        "goals.target": {"name": "rocker.angle.stroke", "value": 0.8},
        "goals.trace": {"point": "C", "through": [(1, 2), (3, 4)], "driver": None, "in_order": True},
        "goals.transmits": {"link": "rocker", "least": 0.5},
        "laws.FunctionLaw": {"f": np.sin},
        "laws.constant_acceleration": {"acceleration": 1.0, "speed": 1.0, "start": 0.0},
        "laws.constant_speed": {"speed": 1.0, "start": 0.0},
        "laws.dwell": {"over": 1.0},
        "laws.fall": {"amount": 1.0, "over": 1.0, "law": "cycloidal", "speed": None, "acceleration": None,
                      "jerk": None},
        "laws.driven_forward": {"motion": h["timed"]},
        "laws.found_law": {"motion": h["timed"], "link": "left", "on": "frame", "pair": ""},
        "laws.motion_table": {"times": [0, 1], "values": [0, 1], "speeds": [0, 0], "accelerations": [0, 0]},
        "laws.place_table": {"times": range(3), "places": [0, 1, 2], "degree": 5, "repeat": False},
        "laws.least_time": {"distance": 1.0, "speed": 1.0, "acceleration": 1.0, "jerk": 1.0, "over": None,
                            "start": 0.0},
        "laws.program": {"start": 0.0, "repeat": False},
        "laws.rise": {"amount": 1.0, "over": 1.0, "law": "cycloidal", "speed": None, "acceleration": None,
                      "jerk": None},
        "laws.synchronised": {},
        "laws.time_table": {"times": range(9), "values": range(9), "degree": 5, "repeat": False},
        "figures.balancing_springs": {"forces": h["sprung"], "springs": "balancer", "even": False, "most": None,
                                      "within": 0.01},
        "figures.counterweights": {"what": h["forces"].motion, "links": "crank", "mass": None, "radius": 1.0,
                                   "disc": 0.0, "fraction": None, "about": None},
        "figures.drive_figures": {"forces": h["forces"], "driver": "crank"},
        "figures.equilibria": {"mechanism": h["forces"].mechanism, "values": None},
        "figures.equivalent_inertia": {"motion": h["moved"]},
        "figures.force_ratio": {"motion": motion, "output": "rocker", "driver": "crank"},
        "figures.harmonics": {"of": h["forces"], "name": "frame.shaking_force", "orders": 3, "driver": "crank"},
        "linkages.four_bar": {"ground": 60.0, "crank": 20.0, "coupler": 50.0, "rocker": 40.0, "point": (30.0, 0.3),
                              "closure": "open", "unit": "mm"},
        "linkages.slider_crank": {"crank": 20.0, "rod": 60.0, "offset": 5.0, "closure": "open", "unit": "mm"},
        "linkages.inverted_slider_crank": {"ground": 50.0, "crank": 20.0, "unit": "mm"},
        "linkages.quick_return": {"kind": "crank-shaper", "ground": 25.0, "crank": 10.0, "lever": 65.0, "rod": 30.0,
                                  "height": 50.0, "unit": "mm"},
        "linkages.six_bar": {"kind": "Watt II", "ground": 60.0, "crank": 20.0, "coupler": 50.0, "rocker": 40.0,
                             "fifth": 45.0, "sixth": 35.0, "coupler_point": None, "rocker_point": (25.0, -0.5),
                             "crank_point": None, "plate_point": None, "pivot": (100.0, 10.0), "closure": "open",
                             "second": "open", "unit": "mm"},
        "linkages.five_bar": {"ground": 50.0, "left": 20.0, "left_coupler": 50.0, "right_coupler": 50.0,
                              "right": 20.0, "closure": "open", "unit": "mm"},
        "linkages.geared_five_bar": {"ground": 50.0, "left": 20.0, "left_coupler": 50.0, "right_coupler": 50.0,
                                     "right": 20.0, "ratio": -1.0, "phase": 0.5, "closure": "open", "unit": "mm"},
        "linkages.scotch_yoke": {"crank": 20.0, "unit": "mm"},
        "linkages.toggle": {"crank": 20.0, "rod": 100.0, "upper": 60.0, "lower": 60.0, "pivot": (110.0, 55.0),
                            "unit": "mm"},
        "linkages.scissor": {"stages": 2, "arm": 2.0, "low": 0.7, "high": 1.9, "unit": "m"},
        "linkages.geneva": {"slots": 4, "distance": 100.0, "unit": "mm"},
        "linkages.cam_follower": {"base": 40.0, "rise": 30.0, "rise_over": 2.0, "dwell_over": 1.0, "fall_over": 2.0,
                                  "follower": "roller", "roller": 10.0, "offset": 0.0, "law": "3-4-5", "unit": "mm"},
        "linkages.planetary": {"sun": 32, "planet": 20, "module": 2.0, "driver": "arm", "unit": "mm"},
        "figures.noncircular_drive": {"forces": h["forces"], "driver": "crank"},
        "figures.flywheel": {"forces": h["forces"], "fluctuation": 0.02, "driver": "crank"},
        "figures.strength": {"forces": h["forces"], "sections": {"coupler": {"diameter": 1.0}}, "elasticity": None,
                             "pins": {"B": (1.0, 2.0)}},
        "tasks.poses": {"link": "plate", "poses": FIVE_POSES[:3], "velocities": {0: (1, 0, 0.5)},
                        "accelerations": {0: (0, 1, 0.5)}, "tolerance": 0.0},
        "tasks.points": {"points": [(0, 0), (1, 0), (2, 1)], "at": (0.0, 0.5, 1.0), "tolerance": 0.0},
        "tasks.curve": {"points": np.exp(1j * np.arange(12)), "closed": None, "links": 6, "tolerance": 0.0},
        "tasks.mixed": {"poses": FIVE_POSES[:2], "points": [(4, 4)], "link": "coupler", "tolerance": 0.0},
        "tasks.function": {"pairs": [(0, 0), (0.5, 0.3), (1, 0.8)], "between": None, "inputs": None,
                           "outputs": None, "count": 3, "linkage": "four-bar", "absolute": False, "tolerance": 0.0},
        "tasks.dwell": {"swing": 0.5, "dwells": (1.0, 0.7), "tolerance": 0.0},
        "tasks.output": {"linkage": h["solved"], "angles": (0.0, 0.1, 0.2), "pivot": (6, 3), "tolerance": 0.0},
        "tasks.swing": {"angle": 0.7, "time_ratio": 1.2},
        "tasks.stroke": {"length": 100.0, "time_ratio": 1.25, "linkage": "slider-crank", "offset": 40.0},
        "plots.centrodes": {**on, "pose": 0, "design": 0, "every": None, "title": None, "size": None, "on": "frame"},
        "plots.circuits": {"what": m, "driver": "crank", "values": None, "between": None, "design": 0, "title": None,
                           "size": None},
        "plots.bar_diagrams": {"found": ck.figures.strength(h["forces"]), "pose": None, "design": 0, "title": None,
                               "size": None},
        "plots.motor_curves": {"sized": ck.figures.sizing(h["forces"]), "motor": None, "title": None, "size": None},
        "plots.bearing_loads": {"motion": motion, "every": None, "designs": (), "title": None, "size": None},
        "plots.hodograph": {"motion": motion, "every": None, "designs": (), "title": None, "size": None},
        "plots.paths": {"motion": motion, "on": "frame", "every": None, "designs": (), "title": None, "size": None},
        "plots.phase": {"motion": motion, "name": "rocker.angle", "rate": None, "every": None, "designs": (),
                        "title": None, "size": None},
        "plots.polar": {"motion": motion, "around": None, "designs": (), "title": None, "size": None},
        "plots.workspace": {"region": h["region"], "colour": None, "singular": True, "title": None, "size": None},
        "plots.scatter_matrix": {"result": h["studied"], "colour": None, "title": None, "size": None},
        "plots.pareto": {"result": h["studied"], "first": "crank.B.x", "second": "rocker.angle.stroke", "greatest": (),
                         "colour": None, "title": None, "size": None},
        "plots.bands": {"result": h["tolerances"], "percentiles": (5.0, 95.0), "relative": True, "title": None,
                        "size": None},
        "plots.contributions": {"result": h["tolerances"], "name": "P.x", "pose": 0, "title": None, "size": None},
        "plots.histogram": {"result": h["tolerances"], "name": "P.x", "pose": 0, "percentiles": None, "title": None,
                            "size": None},
        "plots.improvement": {"optimum": h["optimum"], "title": None, "size": None},
        "plots.starts": {"optimum": h["optimum"], "title": None, "size": None},
        "plots.timing_chart": {"what": m, "over": None, "title": None, "size": None},
        "profiles.conjugate": {"program": h["wave"], "base": 20.0, "second_base": None, "follower": "roller",
                               "roller": 2.0, "second_roller": None, "offset": 0.0, "angle": 0.0, "pivot": 40.0,
                               "arm": 40.0, "second_arm": None, "face": 0.0, "second_face": None, "side": 1,
                               "clockwise": False, "start": 0.0},
        "profiles.constant_breadth": {"program": h["wave"], "base": 20.0, "follower": "flat", "roller": 0.0,
                                      "angle": 0.0, "clockwise": False, "start": 0.0},
        "profiles.disc": {"radius": 1.0, "middle": 0j},
        "profiles.formula": {"function": lambda t: np.exp(1j * t), "low": 0.0, "high": 6.0, "closed": True},
        "profiles.profile": {"points": [(0, 1), (1, 0), (0, -1), (-1, 0)], "closed": True},
        "profiles.synthesise": {"program": h["program"], "base": 20.0, "follower": "knife", "roller": 0.0,
                                "offset": 0.0, "angle": 0.0, "pivot": None, "arm": 0.0, "face": 0.0, "side": 1,
                                "clockwise": False, "start": 0.0},
    }  # fmt: skip
    return {name: (reached(name), given) for name, given in found.items()}


# Arguments without a name: what is given for one of them.
MORE = {
    "Mechanism": "items", "link": "letters", "mode": "links", "plot": "names", "chains.mechanism_from": "drivers",
    "laws.program": "segments", "laws.synchronised": "programs", "plots.circuits": "names",
    "plots.scatter_matrix": "names", "plots.bands": "names", "plots.improvement": "names",
    "plots.bar_diagrams": "bars",
    "plots.bearing_loads": "pairs", "plots.hodograph": "names", "plots.paths": "points", "plots.polar": "names",
}  # fmt: skip


def reached(name: str) -> Any:
    found: Any = ck
    for part in name.split("."):
        found = getattr(found, part)
    return found


def tried(name: str) -> Iterator[tuple[str, Any, Callable[[], Any]]]:
    """Every wrong object in the place of every argument."""
    call, given = calls()[name]
    for key in given:
        for wrong in WRONG:
            yield key, wrong, lambda key=key, wrong=wrong: call(**{**given, key: wrong})
    if name in MORE:
        first = [p.name for p in inspect.signature(call).parameters.values()
                 if p.kind is p.POSITIONAL_OR_KEYWORD]  # fmt: skip
        placed, rest = [given[key] for key in first if key in given], {k: v for k, v in given.items() if k not in first}
        for wrong in WRONG:
            yield MORE[name], wrong, lambda wrong=wrong: call(*placed, wrong, **rest)


# Classes that check what they are given are tried too; functions that take nothing, and what is either of two classes,
# are not.
CLASSES = {
    "Mechanism", "chains.Chain", "chains.Chain.from_code", "chains.Chain.of", "chains.Coloured", "chains.Composer",
    "chains.Joint", "chains.Joints", "equations.MovingLine", "equations.MovingPoint", "figures.ForcePort",
    "figures.LinkPosition", "figures.TorquePort", "laws.FunctionLaw",
}  # fmt: skip
LEFT_OUT = {"exchange.formats", "exchange.shipped", "figures.Port"}


def named() -> list[str]:
    """The names of all that is tried, without what it is given, which takes seconds to make."""
    public = {*ck.__all__, *(f"{part}.{name}" for part in ck._MODULES for name in reached(part).__all__)}
    functions = {n for n in public - LEFT_OUT if callable(reached(n)) and not inspect.isclass(reached(n))}
    return sorted(functions | CLASSES)


def test_every_public_function_is_tried() -> None:
    assert sorted(calls()) == named()


@pytest.mark.full
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", named())
def test_wrong_objects_are_refused_by_errors_of_the_package(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # some of them are names of files, which are then written
    monkeypatch.chdir(tmp_path)
    offenders = []
    for key, wrong, call in tried(name):
        try:
            call()
        except ck.errors.CompoundkinError:
            pass
        except Exception as error:
            offenders.append(f"{key}={wrong!r:.40}: {type(error).__name__}: {str(error)[:80]}")
    assert not offenders, "\n".join(offenders)
