"""The configuration curve: where a mechanism goes along its drivers' path, made once; poses are read off it.

`driver_path` is the path, by arc length; `modes` chooses at home, where the mechanism is drawn. Groups without a closed
form begin in `closed_states` and are followed along `group_paths`; `turn_counting` counts the turns of links. All that
is one value, the `configuration_curve`, and `followed_poses` are the poses of a motion on it. `change_points` finds
where dyads change their sign, and `double_roots` solves the poses there.
"""
