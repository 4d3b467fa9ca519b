"""Names and modules of former versions, and what is written for them now."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

MOVED: Mapping[str, str] = MappingProxyType(
    {
        "advantage": "compoundkin.figures",
        "cams": "compoundkin.figures",
        "coupler": "compoundkin.figures",
        "equivalents": "compoundkin.figures",
        "performance": "compoundkin.figures",
        "machine": "compoundkin.figures",
        "composing": "compoundkin.chains",
        "catalog": "compoundkin.load",
        "Animation": "compoundkin.results.Animation",
        "CamAnalysis": "compoundkin.results.CamAnalysis",
        "Check": "compoundkin.results.Check",
        "Composer": "compoundkin.chains.Composer",
        "CompoundkinError": "compoundkin.errors.CompoundkinError",
        "Finding": "compoundkin.results.Finding",
        "Gap": "compoundkin.results.Gap",
        "InvalidInput": "compoundkin.errors.InvalidInput",
        "InvalidMechanism": "compoundkin.errors.InvalidMechanism",
        "MobilityAnalysis": "compoundkin.results.MobilityAnalysis",
        "Motion": "compoundkin.results.Motion",
        "NotAssembled": "compoundkin.errors.NotAssembled",
        "NotDetermined": "compoundkin.errors.NotDetermined",
        "Page": "compoundkin.results.Page",
        "Picture": "compoundkin.results.Picture",
        "Structure": "compoundkin.results.Structure",
        "UnassembledPoses": "compoundkin.errors.UnassembledPoses",
        "UnknownName": "compoundkin.errors.UnknownName",
        "cam_analysis": "compoundkin.figures.cam_analysis",
        "constant_acceleration": "compoundkin.laws.constant_acceleration",
        "constant_speed": "compoundkin.laws.constant_speed",
        "disc": "compoundkin.profiles.disc",
        "draw_structure": 'compoundkin.draw(mechanism, kind="groups")',
        "dwell": "compoundkin.laws.dwell",
        "equivalent_linkage": "compoundkin.figures.equivalent_linkage",
        "fall": "compoundkin.laws.fall",
        "formula": "compoundkin.profiles.formula",
        "profile": "compoundkin.profiles.profile",
        "program": "compoundkin.laws.program",
        "random_mechanism": "compoundkin.chains.random_mechanism",
        "rendered": "compoundkin.report(mechanism).text()",
        "rise": "compoundkin.laws.rise",
        "save_table": 'compoundkin.save(motion.table(), "motion.csv")',
        "time_table": "compoundkin.laws.time_table",
        "to_pandas": "motion.to_pandas()",
        "vector_polygon": 'compoundkin.draw(motion, kind="polygon")',
    }
)
