"""What people see: sketches, plots, animations, pages, reports, notebooks."""

from compoundkin.base import display

display.register(
    html="compoundkin.view.notebook:html_of",
    svg="compoundkin.view.notebook:svg_of",
    text="compoundkin.view.notebook:text_of",
    synthesis_report="compoundkin.view.report.synthesis_report:synthesis_report",
    synthesis_picture="compoundkin.view.sketch.synthesis_pictures:synthesis_picture",
    dyads_picture="compoundkin.view.sketch.synthesis_pictures:dyads_picture",
    cognates_picture="compoundkin.view.sketch.synthesis_pictures:cognates_picture",
    plot="compoundkin.view.plot:plot",
    study_plot="compoundkin.view.plot.study_plot:study_plot",
    workspace="compoundkin.view.plot:workspace",
    animation="compoundkin.view.animation:animate",
)
