"""The texts of two benchmarks: the gold's edges, durations and makespans; mutated texts.

All of them, and more mutations, are judged by benchmarks/english.py; here a part.
"""

from __future__ import annotations

import random
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import pytest

import irc
from paths import ROOT

BENCHMARK = ROOT / "benchmarks" / "english.py"


def load_benchmark() -> ModuleType:
    """The module of the benchmark, which is in no package."""
    import sys

    spec = spec_from_file_location("benchmark_english", BENCHMARK)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


benchmark = load_benchmark()


@pytest.mark.slow
@pytest.mark.shared_data
def test_asyncplan_texts_give_the_gold_edges_and_durations(shared_data: Path) -> None:
    for instance in list(benchmark.planned(shared_data))[::28]:
        edges, seconds = benchmark.reading(irc.loads(instance.text).ir)
        assert edges == instance.edges, instance.key
        assert seconds == instance.seconds or instance.erratum, instance.key


@pytest.mark.slow
@pytest.mark.shared_data
def test_asynchow_makespans_lie_in_the_gold(shared_data: Path) -> None:
    assert benchmark.judge_asynchow(shared_data, every=8) == {"in gold": 20}


VALID = ("must precede → precedes", "… → depends on", "must follow", "dropped", "half", "takes")


@pytest.mark.slow
@pytest.mark.shared_data
@pytest.mark.parametrize("name", benchmark.MUTATIONS)
def test_a_changed_text_is_read_as_changed_or_refused(name: str, shared_data: Path) -> None:
    rng = random.Random(name)
    sound = [i for i in benchmark.planned(shared_data) if not i.erratum and i.edges]
    sound = [i for i in sound if benchmark.TIMED.search(i.text)]
    verdicts = {benchmark.judge_mutation(name, rng.choice(sound), rng) for _ in range(2)}
    assert "WRONG" not in verdicts
    if name in VALID:
        assert verdicts == {"as meant"}
