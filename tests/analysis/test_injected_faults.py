"""`verify` tells right from wrong: every shipped mechanism passes, and every fault put into it is found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.analysis.checks.continuation_check import choice_findings, continuation_findings
from compoundkin.analysis.checks.residuals import residuals
from tests import catalog
from tests.analysis.injected_faults import flips, link_faults

# Groups of each mechanism that are put on other configurations: every one would take minutes in all.
GROUPS = 2
# Contacts are searched anew in every step of a continuation: these mechanisms take seconds.
CAMS = ("flat-faced-follower", "oscillating-flat-follower", "oscillating-roller-follower", "disc-cam-roller-program")


@catalog.each(catalog.CHOSEN)
def test_right_motions_pass_and_every_fault_is_found(name):
    motion = catalog.motion(name)
    check = ck.verify(motion)
    assert (check.failed, check.passed, check.singular) == ((), True, 0)
    assert check.verdict == f"all {len(check.findings)} checks passed"
    if name not in catalog.THIRD:
        return
    missed = []
    with np.errstate(all="ignore"):
        for fault, wrong in flips(motion, 1 if name in CAMS else GROUPS):
            find = choice_findings if fault.endswith("throughout") else continuation_findings
            missed += [fault] * all(found.passed for found in find(wrong))
        missed += [fault for fault, wrong in link_faults(motion) if all(found.passed for found in residuals(wrong))]
    assert not missed


def test_most_mechanisms_have_faults_of_every_kind():
    """The harness itself: what it makes is no empty list."""
    kinds = {"at one pose": 0, "from one pose on": 0, "throughout": 0}
    for name in ("crank-rocker", "six-bar", "watt-i", "class-iii-six-bar", "four-bar-norton-crossed"):
        for fault, _ in flips(catalog.motion(name), 9):
            kinds[next(kind for kind in kinds if fault.endswith(kind))] += 1
    assert min(kinds.values()) >= 4


def test_a_whole_motion_on_the_other_side_of_its_drawing_is_found():
    faults = dict(flips(catalog.motion("crank-rocker"), 1))
    failed = ck.verify(faults["coupler/rocker throughout"]).failed
    assert "nearest to the drawing" in failed


def test_a_whole_motion_in_the_mode_that_is_not_written_is_found():
    faults = dict(flips(catalog.motion("four-bar-norton-crossed"), 1))
    failed = ck.verify(faults["coupler/rocker throughout"]).failed
    assert "written modes" in failed


def test_the_four_bar_just_before_its_limit_passes():
    """A(0,0) B(8,14) D(20,17) E(37,0): its limit is 0.02 degrees after a pose of 5 degrees' steps."""
    links = (ck.link("frame", "A", "E"), ck.link("ab", "A", "B"), ck.link("bd", "B", "D"), ck.link("de", "D", "E"))
    drawn = ck.drawn(A=(0, 0), B=(8, 14), D=(20, 17), E=(37, 0))
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(ck.Mechanism("before a limit", *links, ck.drive("ab"), drawn))
    assert motion.assembled.sum() == 32
    check = ck.verify(motion)
    assert check.failed == ()
    assert {"continuity", "gaps that can be closed", "nearest to the drawing"} <= {f.name for f in check.findings}


def test_a_gap_that_can_be_closed_is_found():
    motion = catalog.motion("crank-rocker")
    failed = np.array(motion.failed)
    failed[0, 20:30] = 1
    check = ck.verify(replace(motion, failed=failed))
    assert check.failed == ("gaps that can be closed",)
    finding = next(found for found in check.findings if not found.passed)
    assert finding.pose in ((20,), (29,))


def test_nothing_assembled_is_one_answer_everywhere(recwarn):
    mechanism = catalog.mechanism("triple-rocker")
    motion = ck.solve(mechanism, {next(iter(mechanism.drives)).name: np.array([np.pi - 0.1, np.pi])})
    assert not motion.assembled.any()
    check = ck.verify(motion)
    assert (check.passed, check.verdict, check.findings) == (False, "nothing could be checked", ())
    made = ck.report(motion)
    assert made.outcome.passed is False
    said = " ".join(made.text().split())
    assert "0 of 2 poses assembled; nothing could be checked" in said
    assert "checks passed" not in said + made.html()
    assert "nothing could be checked" in made.html()
    assert not [w for w in recwarn if "All-NaN" in str(w.message)]


# Two groups, one after the other, and the driver's range in which the first or the second does not close.
TWO_ROCKERS = (
    ck.link("frame", A=(0, 0), D=(4, 0), F=(9, 0)),
    ck.link("coupler", B=0, C=4),
    ck.link("rocker", D=0, C=2.5),
    ck.link("rod", C=0, E=4),
    ck.link("last", F=0, E=1.6),
    ck.drive("crank"),
)


@pytest.mark.parametrize(("crank", "true"), [(1.0, 2), pytest.param(3.0, 1, marks=pytest.mark.full)])
def test_a_gap_that_names_another_group_is_found(crank, true):
    mechanism = ck.Mechanism("two rockers", ck.link("crank", A=0, B=crank), *TWO_ROCKERS)
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(mechanism, np.linspace(0.0, 2.0 * np.pi, 37))
    gap = motion.failed == true
    assert gap.any()
    assert motion.assembled.any()
    assert ck.verify(motion).failed == ()
    check = ck.verify(replace(motion, failed=np.where(gap, 3 - true, motion.failed)))
    # the one that is named closes, or one before it does not
    assert check.failed == (("gaps that can be closed",) if true == 2 else ("groups before gaps",))
