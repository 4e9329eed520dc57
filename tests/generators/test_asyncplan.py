"""New task graphs have the statistics of the data, the right answer, and a text that says it."""

from __future__ import annotations

import hashlib
import itertools
import json
import statistics
from fractions import Fraction

import pytest

from irc.driver.solve import solve_task
from irc.errors import OptionError
from irc.frontends.files import parse_task
from irc.frontends.importers.asyncplan import import_asyncplan
from irc.generators.asyncplan import generate_plan, plan_document
from irc.generators.dag import TABLE, Measured, statistics_of
from irc.generators.dice import Dice, bell, logarithm, spread, tail
from irc.model import Task
from irc.targets import SolveOptions


def imported(document: dict[str, object]) -> Task:
    ((_, task),) = import_asyncplan(json.dumps(document), "generated")
    return task


def read_back(document: dict[str, object]) -> Task:
    """The task that the front end reads from the English text."""
    return parse_task(str(document["question"]), "question.txt").task


def edges_of(task: Task) -> set[tuple[str, str]]:
    return {(str(p.before), str(p.after)) for p in task.precedence}


def seconds_of(task: Task) -> list[Fraction]:
    """The durations in seconds, by the number of the step."""
    durations = {a.id: a.duration for a in task.actions}
    found = [durations[f"step{k + 1}"] for k in range(len(durations))]
    return [Fraction(getattr(d, "seconds", d)) for d in found]  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("row", TABLE[:4], ids=lambda row: row.size)
def test_fifty_graphs_have_the_statistics_of_the_data(row: Measured) -> None:
    plans = [generate_plan(row.size, 1, index) for index in range(50)]
    found = {
        "edges": [len(plan.dag.edges) for plan in plans],
        "longest": [plan.dag.longest for plan in plans],
        "joins": [plan.dag.joins for plan in plans],
        "parallelism": [sum(plan.durations) / plan.makespan for plan in plans],
    }
    for name, values in found.items():
        mean, deviation = getattr(row, name)
        assert abs(statistics.fmean(values) - mean) <= 2 * deviation / 50**0.5, name
    # The standard error of a deviation is about a tenth of it.
    assert 0.8 < statistics.stdev(found["edges"]) / row.edges[1] < 1.2


@pytest.mark.slow
def test_the_text_says_what_the_graph_says() -> None:
    for size, index in ((3, 0), (3, 1), (5, 0), (17, 0), (60, 0)):
        document = plan_document(generate_plan(size, 7, index))
        gold, read = imported(document), read_back(document)
        assert edges_of(read) == edges_of(gold)
        assert seconds_of(read) == seconds_of(gold)


def critical_path(document: dict[str, object]) -> int:
    """The longest path, by repeated relaxation of each edge."""
    graph = document["graph"]
    assert isinstance(graph, dict)
    ends = list(graph["durations"])
    for _ in ends:
        for a, b in graph["edges"]:
            ends[b] = max(ends[b], ends[a] + graph["durations"][b])
    return int(max(ends))


@pytest.mark.slow
def test_the_gold_answer_is_the_critical_path_and_what_cp_sat_proves() -> None:
    for size, index in itertools.product((3, 12, 40), range(3)):
        document = plan_document(generate_plan(size, 3, index))
        assert document["answer"] == critical_path(document)
        options = SolveOptions(shortcut=False, workers=1)
        schedule = solve_task(imported(document), options).schedule
        assert (schedule.status, schedule.makespan) == ("optimal", document["answer"])


def test_graphs_are_connected_enough_and_leave_work_side_by_side() -> None:
    for index in range(30):
        dag = generate_plan(8, 2, index).dag
        assert {node for edge in dag.edges for node in edge} == set(range(8))
        assert all(a < b for a, b in dag.edges)
        assert 2 <= dag.longest < 8
        assert dag.parts <= 2


def test_an_instance_is_the_same_on_every_machine() -> None:
    text = json.dumps([plan_document(generate_plan(12, 5, index)) for index in range(3)])
    digest = hashlib.sha256(text.encode()).hexdigest()
    assert digest == "51a246c5630bf87f46e1a7a42b1f88c4a3c8250f64b26a83ccf9729b7089c4c3"
    assert plan_document(generate_plan(12, 6, 0))["graph"] != json.loads(text)[0]["graph"]


def test_the_helpers_of_chance_are_what_they_say() -> None:
    import math

    for value in (1e-3, 0.5, 1.0, 3.0, 1e6):
        assert logarithm(value) == pytest.approx(math.log(value), abs=1e-12)
    shares = [(k + 0.5) / 10_000 for k in range(10_000)]
    for quantile, mean in ((bell, 0.0), (tail, 1.0)):
        values = [quantile(share) for share in shares]
        assert statistics.fmean(values) == pytest.approx(mean, abs=0.001)
        assert statistics.pstdev(values) == pytest.approx(1, abs=0.01)
    for column in zip(*(spread(index, Dice("set")) for index in range(50)), strict=True):
        tenths = [sum(k / 5 <= x < (k + 1) / 5 for x in column) for k in range(5)]
        assert all(7 <= count <= 13 for count in tenths)


def test_a_size_beyond_the_table_or_between_its_rows_has_statistics() -> None:
    assert statistics_of(7).edges[0] == pytest.approx(3.66 + 0.4 * (8.82 - 3.66))
    with pytest.raises(OptionError, match="3 to 2,000 steps, not 2"):
        generate_plan(2, 0, 0)
