"""MuJoCo models, written: a tree of bodies with joints, loops closed by equality constraints."""
