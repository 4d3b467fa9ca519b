"""The kinds of inputs of a program."""

from dataclasses import replace

from compoundkin.programs.graph.operation_graph import InputNumber

# a dimension of a link or pair, a driver's value or rate, what is found outside the program, a number of an objective
DIMENSION, DRIVE, SEED, PARAMETER = "dimension", "drive", "seed", "parameter"
# The slope of a driver's value or rate by a number of its law: no program reads it.
LAW_SLOPE = "law slope"

# Parts of seeds: the sign of a group's mode, the angle of a link with full turns.
SIGN, TURNS = "sign", "turns"
# Part of a driver: how far it goes from a pose to the next.
STEP = "step"
# Part of a group's seeds: on which side of a singularity it was a pose before.
SIDE = "side"
# Whether a design's seeds are those of the configuration that the program is in.
HOLDS = InputNumber(SEED, "", "holds")


def group_seed(index: int) -> str:
    """Return what the seeds of a group are called.

    >>> group_seed(2)
    'group 2'
    """
    return f"group {index}"


def start_of(seed: InputNumber) -> InputNumber:
    """Return the seed at each design's first pose.

    >>> start_of(InputNumber("seed", "group 2", "0")).part
    'start 0'
    """
    return replace(seed, part=f"start {seed.part}")
