"""Lowering: in, a checked `Task`; out, a `Problem`, which has integers only."""
