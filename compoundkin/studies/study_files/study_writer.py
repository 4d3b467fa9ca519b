"""From a study to the document of its file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files import exact_numbers
from compoundkin.files.mechanism_files import written_text
from compoundkin.files.parsed_document import known_syntax
from compoundkin.files.writer import document
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.driver_values import by_name
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose
from compoundkin.studies.samples.contract import DesignSample
from compoundkin.studies.study_files import study_keys as keys
from compoundkin.studies.study_files.dimension_units import is_angle_dimension
from compoundkin.studies.study_files.variation_entries import variation_entry
from compoundkin.studies.variations.contract import Variation


class SaysStudy(Protocol):
    """What a study says: the arguments that it was made with, by their names."""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism whose dimensions vary."""

    @property
    def dimensions(self) -> Mapping[str, Variation]:
        """What each dimension may be."""

    @property
    def outputs(self) -> Any:
        """What is found of each design."""

    @property
    def sample(self) -> DesignSample:
        """Which designs."""


def study_text(study: SaysStudy, form: str) -> str:
    """Return the text of a study's file in a form, "toml" or "json"."""
    return written_text(study_document(study), known_syntax(form))


def study_document(study: SaysStudy) -> dict[str, Any]:
    """Return the document that says what a study says, the mechanism in it.

    Raises InvalidInput for what files cannot say: outputs that are Python functions.
    """
    if isinstance(study.outputs, Mapping):
        what, remedy = "a Python function cannot be written to a file", "write outputs by their names"
        raise InvalidInput(Problem(keys.OUTPUTS, what, remedy))
    angles = decompose(study.mechanism).driven_angles
    dimensions = {
        name: variation_entry(one.data, is_angle_dimension(study.mechanism, angles, name))
        for name, one in study.dimensions.items()
    }
    out = {
        keys.FORMAT: keys.FORMATS[-1],
        keys.OUTPUTS: list(study.outputs),
        **study.sample.data,
        keys.TIME: _times(getattr(study, keys.TIME, None)),
        keys.MODES: _modes(getattr(study, keys.MODES, None)),
        keys.DIMENSIONS: dimensions,
        keys.DRIVES: _drives(study, angles),
        keys.MECHANISM: document(study.mechanism),
    }
    return {key: value for key, value in out.items() if value not in (None, {})}


def _times(time: Any) -> Any:
    return None if time is None else exact_numbers.values(time, False)


def _modes(modes: Any) -> Any:
    """Return modes by links, or the name of a configuration."""
    if isinstance(modes, Mapping):
        return {link: int(mode) for link, mode in modes.items()}
    return modes.name if isinstance(modes, Configuration) else modes


def _drives(study: SaysStudy, angles: Mapping[str, bool]) -> dict[str, dict[str, Any]]:
    """Return what drivers do, by driver."""
    found: dict[str, dict[str, Any]] = {}
    for word in (keys.VALUES, *keys.RATES):
        given = by_name(study.mechanism, getattr(study, word, None))
        for name, value in (given or {}).items():
            found.setdefault(name, {})[word] = _WRITE[word](value, angles[name])
    return found


_WRITE: dict[str, Any] = {
    keys.VALUES: exact_numbers.values,
    **dict.fromkeys(keys.RATES, lambda value, _: exact_numbers.plain(value)),
    keys.RATES[0]: exact_numbers.rate,
}
