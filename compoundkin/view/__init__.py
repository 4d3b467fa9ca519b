"""What people see: sketches, plots, animations, pages, reports, notebooks."""

from compoundkin.base import display

display.register(
    html="compoundkin.view.notebook:html_of",
    svg="compoundkin.view.notebook:svg_of",
    text="compoundkin.view.notebook:text_of",
    plot="compoundkin.view.plot:plot",
    study_plot="compoundkin.view.plot.study_plot:study_plot",
    workspace="compoundkin.view.plot:workspace",
    animation="compoundkin.view.animation:animate",
)
