"""Files of the scheduling literature: read as other readers read them, written and read back."""

from __future__ import annotations

import random
from pathlib import Path

import fjsplib
import psplib
import pytest

import irc
from irc.diagnostics import InputError
from irc.frontends.convert import convert_file
from irc.frontends.exporters.projects import write_psplib, write_rcpsp_max
from irc.frontends.exporters.shops import write_flexible_job_shop, write_job_shop
from irc.frontends.files import parse_task
from irc.frontends.formats import EXPORTERS, MS_PROJECT, format_of, load_importer
from irc.model import Task
from irc.model.canonical import canonical_task

PSPLIB = """\
************************************************************************
file with basedata            : own.bas
jobs (incl. supersource/sink ):  5
RESOURCES
  - renewable                 :  2   R
************************************************************************
PRECEDENCE RELATIONS:
jobnr.    #modes  #successors   successors
   1        1          2           2   3
   2        1          1           4
   3        1          1           5
   4        1          1           5
   5        1          0
************************************************************************
REQUESTS/DURATIONS:
jobnr. mode duration  R 1  R 2
------------------------------------------------------------------------
  1      1     0       0    0
  2      1     4       2    0
  3      1     3       2    1
  4      1     2       0    1
  5      1     0       0    0
************************************************************************
RESOURCEAVAILABILITIES:
  R 1  R 2
   3    1
************************************************************************
"""

SCH = """\
3\t1\t0\t0
0\t1\t2\t1\t2\t[0]\t[0]
1\t1\t2\t3\t4\t[2]\t[5]
2\t1\t2\t3\t4\t[-1]\t[4]
3\t1\t2\t4\t1\t[3]\t[-6]
4\t1\t0
0\t1\t0\t0
1\t1\t5\t1
2\t1\t4\t1
3\t1\t3\t1
4\t1\t0\t0
2
"""

RCP = "4 1\n3\n\n0 0 2 2 3\n4 2 1\n4\n3 2 1 4\n0 0 0\n"

JSP = "a comment\n2 2\n0 3 1 2\n1 4 0 1\n"

TAILLARD = """\
Nb of jobs, Nb of Machines, Time seed, Machine seed, Upper bound, Lower bound
 2 2 17 4 7 7
Times
 3 2
 4 1
Machines
 1 2
 2 1
"""

FJS = "2 3 1.5\n2 2 1 5 3 4 1 2 3\n1 2 1 6 2 6\n"

FILES = {
    "psplib": ("own.sm", PSPLIB, 9),
    "rcpsp-max": ("own.sch", SCH, 7),
    "patterson": ("own.rcp", RCP, 7),
    "job-shop": ("own.jsp", JSP, 6),
    "flexible-job-shop": ("own.fjs", FJS, 7),
}


def read(source: str, text: str) -> Task:
    ((_, task),) = load_importer(source)(text, FILES[source][0])
    return task


@pytest.mark.parametrize("source", FILES)
def test_a_file_is_solved_and_written_and_read_back_equal(source: str, tmp_path: Path) -> None:
    name, text, makespan = FILES[source]
    (tmp_path / name).write_text(text)
    assert format_of(name) == source
    convert_file(str(tmp_path / name), None, tmp_path / "task.json")
    task = parse_task((tmp_path / "task.json").read_text()).task
    assert irc.solve(task).makespan == makespan
    convert_file(str(tmp_path / "task.json"), None, tmp_path / f"back_{name}")
    again = read(source, (tmp_path / f"back_{name}").read_text()).model_copy(
        update={"name": task.name}
    )
    assert canonical_task(again) == canonical_task(task)


@pytest.mark.parametrize(
    ("source", "format"),
    [("psplib", "psplib"), ("rcpsp-max", "rcpsp_max"), ("patterson", "patterson")],
)
def test_a_project_is_read_as_psplib_reads_it(source: str, format: str, tmp_path: Path) -> None:
    name, text, _ = FILES[source]
    (tmp_path / name).write_text(text)
    theirs = psplib.parse(tmp_path / name, format)
    ours = read(source, text)
    assert [r.capacity for r in theirs.resources] == [r.capacity for r in ours.resources]
    assert [a.modes[0].duration for a in theirs.activities] == [a.duration for a in ours.actions]
    numbers = {action.id: n for n, action in enumerate(ours.actions)}
    assert [
        (n, after, delay)
        for n, a in enumerate(theirs.activities)
        for after, delay in zip(a.successors, a.delays or [0] * len(a.successors), strict=True)
    ] == [(numbers[p.before], numbers[p.after], p.min_lag) for p in ours.precedence]


def test_a_flexible_job_shop_is_read_as_fjsplib_reads_it(tmp_path: Path) -> None:
    (tmp_path / "own.fjs").write_text(FJS)
    theirs = fjsplib.read(tmp_path / "own.fjs")
    assert theirs.jobs == [[[(0, 5), (2, 4)], [(1, 3)]], [[(0, 6), (1, 6)]]]
    first, second, third = read("flexible-job-shop", FJS).actions
    assert [(m.id, m.duration) for m in first.modes] == [("machine 1", 5), ("machine 3", 4)]
    assert (second.duration, second.uses[0].resource) == (3, "machine 2")
    assert (third.duration, third.uses[0].one_of) == (6, ("machine 1", "machine 2"))


def test_taillards_format_is_the_same_job_shop() -> None:
    bare = "2 2\n3 2\n4 1\n1 2\n2 1\n"
    expected = canonical_task(read("job-shop", JSP))
    assert canonical_task(read("job-shop", TAILLARD)) == expected
    assert canonical_task(read("job-shop", bare)) == expected
    assert canonical_task(read("job-shop", "2 2\n1 3 2 2\n2 4 1 1\n")) == expected


@pytest.mark.parametrize(
    "text",
    ["3 2\n0 3 1 2 0 1\n1 4\n0 2 1 1\n", "3 2\n0 3 1 2 0 1 -1 -1\n1 4 -1 -1\n0 2 1 1 -1 -1\n"],
    ids=["lengths", "ends"],
)
def test_jobs_of_a_re_entrant_job_shop_have_any_length(text: str) -> None:
    task = read("job-shop", text)
    visits = [(a.id, a.uses[0].resource, a.duration) for a in task.actions]
    first, second, third = "machine 1", "machine 2", "machine 1"
    assert visits[:3] == [("job 1.1", first, 3), ("job 1.2", second, 2), ("job 1.3", third, 1)]
    assert visits[3:4] == [("job 2.1", "machine 2", 4)]
    assert irc.solve(task).makespan == 7
    written = write_job_shop(task)
    assert written.count("-1 -1") == 3
    assert canonical_task(read("job-shop", written)) == canonical_task(task)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("3 2\n0 3 1 2\n1 4\n0 2 1 1\n", "job 2: expected 4 numbers, found 2"),
        ("3 2\n0 3 1\n1 4\n0 2 1 1\n", "job 1: a duration is missing"),
        ("3 2\n0 3 -1 -1\n-1 -1\n0 2 1 1 -1 -1\n", "job 2: the job has no operation"),
        ("3 2\n0 3 -1 -1 4 5\n1 1 0 1 0 2\n0 2 1 1 -1 -1\n", "expected 0 or more, found -1"),
    ],
)
def test_one_line_of_another_length_is_a_fault(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read("job-shop", text)


def test_a_file_of_many_job_shops_has_their_names() -> None:
    text = " instance abc1\n +++++\n 1 1\n 0 3\n instance abc2\n 1 1\n 0 4\n"
    found = list(load_importer("job-shop")(text, "many.txt"))
    assert [(stem, task.actions[0].duration) for stem, task in found] == [("abc1", 3), ("abc2", 4)]


@pytest.mark.parametrize("source", FILES)
def test_a_cut_file_is_refused_at_its_place_or_whole(source: str) -> None:
    """A cut after the last number is whole; a cut within it reads another number."""
    text = FILES[source][1]
    whole = canonical_task(read(source, text))
    read_as_whole = 0
    for end in range(len(text)):
        try:
            cut = read(source, text[:end])
        except InputError as error:
            (fault,) = error.report.located()
            assert fault.line is not None
        else:
            read_as_whole += canonical_task(cut) == whole
            assert len(cut.actions) == len(whole["actions"]) or source == "job-shop"
    assert read_as_whole <= len(text) - len(text.rstrip("*\n")) + 1


@pytest.mark.parametrize(
    ("source", "old", "new", "message", "line"),
    [
        ("psplib", "2   3\n", "2   9\n", "job 1: there is no job 9", 9),
        ("psplib", "4       2    0", "x       2    0", "expected a whole number, found 'x'", 19),
        ("psplib", "2       0    1", "2       0", "job 4, mode 1: expected 5 numbers, found 4", 21),
        ("psplib", "R 1  R 2\n---", "R 1  D 1\n---", "doubly constrained", 16),
        ("rcpsp-max", "[-6]", "[-6] 3", "1 more numbers than the format has here", 5),
        ("rcpsp-max", "3\t1\t0\t0", "3\t1\t2\t0", "non-renewable", 1),
        ("patterson", "3 2 1 4", "3 2 1 7", "activity 3: a successor: expected 4 or less", 7),
        ("job-shop", "1 4 0 1", "3 4 0 1", "a machine: expected 2 or less, found 3", 4),
        ("job-shop", "0 3 1 2", "0 3 2 2", "neither 0 to 1 nor 1 to 2", 3),
        ("flexible-job-shop", "1 2 3\n", "1 4 3\n", "a machine: expected 3 or less, found 4", 2),
        ("flexible-job-shop", "3 4 1 2 3\n", "3 4 1 2 -3\n", "expected 0 or more, found -3", 2),
    ],
)
def test_a_fault_has_its_place(source: str, old: str, new: str, message: str, line: int) -> None:
    text = FILES[source][1]
    assert text.count(old) == 1
    with pytest.raises(InputError) as raised:
        read(source, text.replace(old, new))
    (fault,) = raised.value.report.located()
    assert message in fault.message
    assert fault.line == line


def test_delays_count_from_zero() -> None:
    """Nothing moves the source: a greatest delay from it is a limit in time."""
    late = "1 1 0 0\n0 1 1 1 [4]\n1 1 2 2 0 [1] [-3]\n2 1 0\n0 1 0 0\n1 1 1 1\n2 1 0 0\n1\n"
    assert irc.solve(read("rcpsp-max", late)).status == "infeasible"


def test_what_a_format_cannot_say_is_refused() -> None:
    task = Task(
        name="plan",
        actions=[
            {"id": "a", "duration": "1/2", "due": 4},
            {"id": "b", "duration": 1, "uses": [{"resource": "m"}]},
        ],
        resources=[{"id": "m", "capacity": 2}],
        precedence=[{"before": "a", "after": "b", "min_lag": 2}],
    )
    for writer in (write_psplib, write_rcpsp_max, write_job_shop, write_flexible_job_shop):
        with pytest.raises(InputError) as raised:
            writer(task)
        text = str(raised.value)
        assert "has no due dates" in text
        assert ("has no minimum lags" in text) == (writer is not write_rcpsp_max)
        assert "whole numbers only, not 0.5 s" in text


def _project(rng: random.Random) -> Task:
    ids = [f"a{n}" for n in range(rng.randint(1, 6))]
    return Task(
        name="random",
        resources=[{"id": "r", "capacity": 2}],
        actions=[
            {
                "id": id,
                "duration": rng.randint(0, 4),
                "uses": [{"resource": "r", "amount": rng.randint(1, 2)}],
                **rng.choice([{}, {}, {"release": 2}, {"deadline": 30}, {"start": 5}]),
            }
            for id in ids
        ],
        precedence=[
            {
                "before": a,
                "after": b,
                "type": rng.choice(["finish-start", "start-start", "finish-finish"]),
                "min_lag": rng.randint(-3, 3),
                **rng.choice([{}, {"max_lag": 6}]),
            }
            for n, a in enumerate(ids)
            for b in ids[n + 1 :]
            if rng.random() < 0.4
        ],
        deadline=rng.choice([None, 40]),
    )


@pytest.mark.parametrize("seed", range(12))
def test_a_random_project_means_the_same_as_rcpsp_max(seed: int) -> None:
    task = _project(random.Random(seed))
    again = read("rcpsp-max", write_rcpsp_max(task))
    ours, theirs = irc.solve(task), irc.solve(again)
    assert (ours.status, ours.makespan) == (theirs.status, theirs.makespan)


def test_every_exporter_has_its_importer() -> None:
    for name in EXPORTERS:
        if name != MS_PROJECT:  # It has a reader of its own: test_ms_project.py.
            load_importer(name)
