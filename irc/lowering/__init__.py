"""Lowering: in, a checked `Task`; out, the same as integers, a `Problem`."""
