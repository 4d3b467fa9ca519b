"""Live pages: the data with which a browser solves and draws a mechanism again when its dimensions change.

The recorded program is a table of operations, evaluated once or at every pose by `machine.js`; no text is evaluated.
Dimensions that cannot change alone are not offered. What the program reproduces, the page does not hold. `design.js`
holds the dimensions and the steps of undo; numbers go one way: `design.change` asks the path (`path.js`), which runs
the machine and makes a `Solved`, never changed afterwards; `player.take` copies it into the shared arrays and tells
the player's listeners; then the design tells its own ("change" at once, "commit" at each step of undo). The sketch is
a second table (`redraw.js`): painters run on traced numbers, whose operations are recorded while branches follow the
values; `complex()` and `float()` would lose the trace.
"""
