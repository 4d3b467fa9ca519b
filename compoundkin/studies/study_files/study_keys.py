"""What a study file holds: the keys that reader, writer and schema follow."""

from __future__ import annotations

from compoundkin.model.attributes import OF_DRIVERS
from compoundkin.model.elements import Drive
from compoundkin.model.fields import Key
from compoundkin.studies.samples import SAMPLES

FORMATS = (1,)
FORMAT_DOC = f"The version of this file format; known: {', '.join(map(str, FORMATS))}."

FORMAT, MECHANISM, DIMENSIONS, DRIVES, MODES = "format", "mechanism", "dimensions", "drives", "modes"
OUTPUTS, SAMPLE, COUNT, SEED, TIME = "outputs", "sample", "count", "seed", "time"

HEAD = (
    Key(OUTPUTS, "names", 'What is found of each design, such as "ram.stroke" or "G.position".', required=True),
    Key(COUNT, "whole", "How many designs."),
    Key(SEED, "whole", "Makes random samples repeatable.", default=0),
    Key(TIME, "times", "The times in seconds at which drivers with laws are solved."),
)
# What is read by rules of its own.
OTHERS = {
    MECHANISM: "The path of its file, seen from this one; the name of a shipped mechanism; or its whole document.",
    DIMENSIONS: 'What each dimension may be, by its name in quotes: "crank.B" = { low = 40, high = 60 }; '
    "or the path of a CSV or Parquet table of designs.",
    DRIVES: "What drivers do, by name; the mechanism's own motion where they are left out.",
    MODES: "The assembly modes by links, 1 or -1; or the name of a configuration.",
    SAMPLE: f"Which designs: {', '.join(SAMPLES)}; or the number of levels of each dimension.",
}

VALUES, *RATES = ("values", *OF_DRIVERS[1:])
# What drivers do, as mechanism files say it.
DRIVEN = tuple(key for key in Drive.keys if key.name in (VALUES, *RATES))

# What a variation says that has the unit of its dimension, degrees of an angle; all else has none.
WITH_UNIT = ("low", "high", "centre", "within", "values", "loc", "scale")
