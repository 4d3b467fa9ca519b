"""Dimensional synthesis: mechanisms out of tasks, exactly or as near as they come, each judged by its own circuits.

A `Task` (`tasks`) is data. A method is a function from a task to `Candidates` (`candidates`), linkages that meet the
task at its precision positions and may have any defect, with `complete`, what of how many was found. `METHODS`
(`synthesis`) lists for each class of task its methods, the first that `fits` is taken. To add one, write in a file of
its own

    def six_points(task: PointTask) -> Candidates:
        a, b, A, B = ...                       # complex arrays (candidates,): fixed pivots; joints at the first point
        return Candidates(of_points(task.points, a, b, A, B), complete="12 of 12 linkages", note="...")

and enter ``Method(PointTask, six_points, fits=lambda task: len(task.points) == 6)`` in `METHODS`. Candidates of dyads
on one body are made by `of_dyads`, of fixed pivots and joints by `of_points`; any other linkage is a `Linkage` of its
own, a mechanism drawn at the first precision position with the poses of all its links at all of them.

Many samples of a curve, a function or a motion are approached by designs of an atlas: of chains whose crank turns fully
(`curve_chains`) those nearest to the samples, over all ways to lay them (`coupler_atlas`, `sampled_functions`,
`sampled_motions`), are refined together by steps with exact slopes (`design_refinement`, `curve_fitting`).

What is wrong with a candidate is found in one place for all methods (`defects`): its circuits are followed, the
precision positions placed on them, and what remains is solved, compared with the task and ranked (`synthesis`).
"""
