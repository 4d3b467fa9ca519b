"""What knows no mechanism: errors, series, poses, curves, linear algebra, Newton's method, continuation.

Numbers are Python's own, arrays or recorded ones: kernels are straight-line arithmetic without branches on values.
"""
