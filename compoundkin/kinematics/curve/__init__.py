"""The configuration curve: where a mechanism goes along its drivers' path, made once; poses are read off it.

`driver_path` is the path, by arc length; `modes` chooses at home, where the mechanism is drawn; `group_paths` follows
groups without a closed form, and `change_points` finds where dyads change their sign; `configuration_curve` has all of
them as one value, and the poses of a motion on it.
"""
