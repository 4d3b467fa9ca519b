"""Results of designs side by side, kept for a few poses in lanes and then written along the poses of each design.

Written lane by lane at once, each number would go to another place in memory.
"""

from __future__ import annotations

from compoundkin.programs.backends.llvm.llvm_control import ControlText
from compoundkin.programs.backends.llvm.llvm_plan import HEADER, LanePlan

STAGED = "staged"


def staging_text(plan: LanePlan, parameters: str) -> str:
    """Return the function that writes what is kept."""
    text = ControlText()
    lanes = text.least(text.whole("sub", "%end", "%d"), plan.machine.lanes)
    poses = text.whole("sub", "%to", "%from")
    for i, array in enumerate(plan.staged):
        row = text.words("%S", HEADER + 3 * array)
        by_design, by_pose = text.loaded(row, 1), text.loaded(row, 2)
        offset = text.whole("add", text.whole("mul", "%d", by_design), text.whole("mul", "%from", by_pose))
        ahead = text.whole("mul", by_pose, plan.piece)
        first = _behind(text, text.loaded(row, 0, "ptr"), offset)
        kept = text.words("%S", plan.at_staged + i * plan.piece * plan.machine.lanes)
        with text.steps(0, lanes) as lane:
            target = _behind(text, first, text.whole("mul", lane, by_design))
            source = text.words(kept, lane)
            with text.steps(0, poses) as pose:
                value = text.loaded(source, text.whole("mul", pose, plan.machine.lanes), "double")
                place = _behind(text, target, text.whole("mul", pose, by_pose))
                text.do(f"call void @llvm.prefetch.p0(ptr {_behind(text, place, ahead)}, i32 1, i32 3, i32 1)")
                text.do(f"store double {value}, ptr {place}")
    return "\n".join([f"define internal void @{STAGED}({parameters}) #0 {{", "entry:", *text.lines, "  ret void", "}"])


def _behind(text: ControlText, place: str, offset: str) -> str:
    """Write the place so many bytes behind another."""
    return text.put(f"getelementptr i8, ptr {place}, i64 {offset}")
