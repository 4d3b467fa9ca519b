"""The colours of a page, on light and on dark paper: those of the pictures, and a few of its own."""

from __future__ import annotations

from compoundkin.view.sketch import sketch_style

# Those that pictures do not have. Words in `good`, `bad` and `link` keep a contrast of 4.5 : 1 with every ground they
# stand on (WCAG 2.2, 1.4.3).
OWN: dict[str, tuple[str, str]] = {
    "ground": ("#f5f6f8", "#0d0f13"),
    "soft": ("#eef1f4", "#1d2129"),
    "rule": ("#d9dde3", "#2e343d"),
    "quiet": ("#545d69", "#a3adba"),
    "link": ("#00579a", "#7cc0f7"),
    "lit": ("#fff0bd", "#3d3512"),
    "good": ("#006b4f", "#52d1a8"),
    "bad": ("#b3261e", "#ff8a80"),
    "bad-ground": ("#fdf0ee", "#2e1817"),
}


def palette() -> str:
    """The style rules that name all colours; paper that is printed on is light."""
    colours = {"paper": sketch_style.PAPER, "ink": sketch_style.INK, **OWN}
    colours |= {f"g{k}": pair for k, pair in enumerate(sketch_style.COLOURS)}
    light, dark = ("".join(f"--{name}:{pair[k]};" for name, pair in colours.items()) for k in (0, 1))
    swatches = "\n".join(f".g{k}{{background:var(--g{k})}}" for k in range(len(sketch_style.COLOURS)))
    return "\n".join(
        (
            f":root{{color-scheme:light;{light}}}",
            f"@media screen{{:root[data-theme=dark]{{color-scheme:dark;{dark}}}}}",
            "@media screen and (prefers-color-scheme:dark)"
            f"{{:root:not([data-theme=light]){{color-scheme:dark;{dark}}}}}",
            swatches,
        )
    )
