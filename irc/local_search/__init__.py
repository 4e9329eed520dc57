"""From a problem to better schedules of it: local search over arrays, without a clock or proofs."""
