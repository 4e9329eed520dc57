"""The parts of `benchmarks/league.py`: instances, competitors, figures."""
