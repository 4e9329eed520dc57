"""Where the files are that tests read."""

from __future__ import annotations

from pathlib import Path

TESTS = Path(__file__).resolve().parent
ROOT = TESTS.parent
EXAMPLES = ROOT / "examples"
CORPUS = TESTS / "corpus"
"""Wrong inputs, and the table of what is said of each."""
FAKES = TESTS / "fakes"
"""Programs that pose as planners."""
GOLDEN_TASKS = TESTS / "golden" / "tasks"
SHARED_DATA = ROOT.parent / "shared" / "data"
"""Benchmark data beside the project; tests that read it are marked `shared_data`."""
