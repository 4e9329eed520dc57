"""Slow, simple, independent answers that the compiler's own are compared with."""
