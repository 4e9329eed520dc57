"""Batches: in, tasks, targets and engines; out, a result for each trial, and a summary."""
