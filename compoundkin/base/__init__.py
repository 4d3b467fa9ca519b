"""What knows no mechanism: errors, series, poses, curves, linear algebra."""
