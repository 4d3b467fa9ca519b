"""LLVM: a flat program as machine code, in lanes along the poses or the designs."""
