"""A batch gives one result for each task, target and engine, whatever happens to any of them."""

from __future__ import annotations

import gzip
import json
import os
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

import irc
from api.test_running import shop
from irc.batches.batch import Batch, BatchOptions
from irc.batches.inputs import InputOptions
from irc.batches.result import BatchResult, read_result
from irc.batches.trial import TrialOptions, pairings
from irc.diagnostics import InputError
from irc.driver.files import WriteError
from irc.errors import OptionError
from irc.targets import Cancellation, EngineMissing, UnknownTarget

posix = pytest.mark.skipif(os.name != "posix", reason="there are no signals")


def chain(*durations: int) -> dict[str, Any]:
    """A task of actions one after the other."""
    actions = [{"id": f"a{k}", "duration": d} for k, d in enumerate(durations)]
    precedence = [[f"a{k}", f"a{k + 1}"] for k in range(len(durations) - 1)]
    return {"actions": actions, "precedence": precedence}


def write(folder: Path, **tasks: Any) -> Path:
    """A folder with a file for each task; texts are written as they are."""
    folder.mkdir(exist_ok=True)
    for name, task in tasks.items():
        text = task if isinstance(task, str) else json.dumps(task)
        (folder / f"{name}.json").write_text(text, "utf-8")
    return folder


def by_name(results: Iterable[BatchResult]) -> dict[str, list[str]]:
    """The statuses of each task, by the name of its file."""
    found: dict[str, list[str]] = {}
    for result in results:
        found.setdefault(Path(result.task).name, []).append(result.status)
    return found


def lines_of(path: Path) -> list[BatchResult]:
    return [read_result(line) for line in path.read_bytes().splitlines(keepends=True)]


LATE = {"actions": [{"id": "a", "duration": 5, "deadline": 3}]}
REFUSED = {
    "actions": [{"id": "a", "duration": 5, "due": 3, "weight": 2}],
    "objective": ["minimize_earliness"],
}


@pytest.mark.slow
def test_every_task_target_and_engine_has_one_result_whatever_becomes_of_the_others(
    tmp_path: Path,
) -> None:
    folder = write(tmp_path / "tasks", good=chain(3, 4), broken="{", late=LATE, due=REFUSED)
    output = tmp_path / "results.jsonl"
    batch = irc.batch([folder, tmp_path / "absent.json"], ("cpsat", "pddl21"), output=output)
    found = list(batch)
    statuses = {name: sorted(statuses) for name, statuses in by_name(found).items()}
    assert statuses == {
        "good.json": ["optimal", "optimal"],
        "broken.json": ["faulty", "faulty"],
        "late.json": ["infeasible", "infeasible"],
        "due.json": ["optimal", "refused"],
        "absent.json": ["faulty", "faulty"],
    }
    assert sorted(r.line() for r in found) == sorted(r.line() for r in lines_of(output))
    assert (batch.total, batch.kept, batch.done, batch.all_read) == (10, 0, 10, True)
    (good, _) = (r for r in found if r.task.endswith("good.json"))
    assert [(o.name, o.value, o.bound) for o in good.objective] == [("makespan", 7, 7)]
    broken = next(r for r in found if r.task.endswith("broken.json"))
    assert broken.outcome.diagnostics[0].to_dict()["line"] == 1


def options(output: Path | None = None, **more: Any) -> BatchOptions:
    return BatchOptions(output=output, processes=1, **more)


@pytest.mark.slow
def test_a_batch_goes_on_where_its_file_ends_and_notices_what_changed(tmp_path: Path) -> None:
    folder = write(tmp_path / "tasks", a=chain(1), b=chain(2), c=chain(3))
    output = tmp_path / "results.jsonl"
    assert len(list(Batch([folder], options(output)))) == 3
    whole = output.read_bytes().splitlines(keepends=True)
    output.write_bytes(b"".join(whole[:2]) + whole[2][:40])  # (as a kill leaves it)
    write(folder, a=chain(9))
    lost = Path(read_result(whole[2]).task).name
    resumed = by_name(Batch([folder], options(output)))
    assert resumed.keys() == {"a.json", lost}
    values = Counter(r.task for r in lines_of(output) if r.objective[0].value != 9)
    assert set(values.values()) == {1}
    assert list(Batch([folder], options(output))) == []
    # Other options are other trials.
    again = options(output, trial=TrialOptions(seed=1))
    assert len(list(Batch([folder], again))) == 3


@pytest.mark.slow
def test_what_ended_with_a_status_is_solved_again_where_that_is_asked_for(tmp_path: Path) -> None:
    folder = write(tmp_path / "tasks", good=chain(1), broken="{")
    output = tmp_path / "results.jsonl"
    assert len(list(Batch([folder], options(output)))) == 2
    assert by_name(Batch([folder], options(output, again=("faulty",)))) == {
        "broken.json": ["faulty"]
    }


def test_a_file_of_anything_else_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    for text in ('{"actions": []}\n', '{"actions": ', "notes"):
        path = tmp_path / "notes.jsonl"
        path.write_text(text, "utf-8")
        with pytest.raises(WriteError, match="line 1 is no result of a batch"):
            Batch([chain(1)], options(path))
        assert path.read_text("utf-8") == text


@posix
def test_two_batches_do_not_write_one_file(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    first = Batch([chain(1)], options(path))
    with pytest.raises(WriteError, match="another batch is writing it"):
        Batch([chain(1)], options(path))
    assert first.total == 0


def names(inputs: list[Any], **how: Any) -> list[str]:
    """The names of the tasks of some inputs."""
    from irc.batches.inputs import listed, tasks_of

    read = InputOptions(**how)
    return [Path(task.name).name for task in tasks_of(listed(inputs, read), read)]


def test_tasks_come_from_files_folders_patterns_and_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write(tmp_path / "tasks", a=chain(1), b=chain(2))
    write(folder / "deep", c=chain(3))
    (folder / "d.irc").write_text("a 5\n", "utf-8")
    (folder / "notes.md").write_text("nothing", "utf-8")
    lines = "\n".join(json.dumps(chain(k)) for k in range(3)) + "\n\n"
    with gzip.open(folder / "many.jsonl.gz", "wt", encoding="utf-8") as file:
        file.write(lines)
    many = [f"many.jsonl.gz:{k}" for k in (1, 2, 3)]
    assert names([folder]) == ["a.json", "b.json", "d.irc", *many]
    assert names([f"{folder}/**/*.json"]) == ["a.json", "b.json", "c.json"]
    assert names([folder / "a.json", folder / "a.json", str(folder / "a.json")]) == ["a.json"]
    assert names([{**chain(1), "name": "x"}, {**chain(2), "name": "x"}]) == ["x", "x (2)"]
    with pytest.raises(InputError, match="no file is called"):
        names([f"{folder}/*.xyz"])
    with pytest.raises(InputError, match="has no task files"):
        names([folder / "deep"], format="pddl")


def test_an_included_file_counts_as_a_part_of_the_task(tmp_path: Path) -> None:
    from irc.batches.inputs import tasks_of

    (tmp_path / "a.irc").write_text('include "b.irc"\na 5 after b\n', "utf-8")
    digests = []
    for duration in (1, 1, 2):
        (tmp_path / "b.irc").write_text(f"b {duration}\n", "utf-8")
        (task,) = tasks_of([str(tmp_path / "a.irc")], InputOptions())
        digests.append(task.sha256)
    assert digests[0] == digests[1] != digests[2]


GRAPH = {"id": 7, "graph": {"edges": [[0, 1]], "durations": [1, 2]}}


def test_a_faulty_instance_does_not_hide_the_others_of_its_file(tmp_path: Path) -> None:
    from irc.batches.inputs import tasks_of
    from irc.diagnostics import Report

    path = tmp_path / "nodes2.json"
    path.write_text(json.dumps([GRAPH, {"id": 8}, {**GRAPH, "id": 9}]), "utf-8")
    found = list(tasks_of([str(path)], InputOptions("asyncplan")))
    kinds = [(task.name.partition("#")[2], isinstance(task.source, Report)) for task in found]
    assert kinds == [("nodes2_7", False), ("2", True), ("nodes2_9", False)]


def test_engines_go_with_the_targets_that_have_them() -> None:
    pairs = pairings(("cpsat", "pddl21"), ("ortools", "kairos", "auto"))
    assert [*pairs] == [
        *(("cpsat", "ortools"), ("cpsat", "auto")),
        *(("pddl21", "kairos"), ("pddl21", "auto")),
    ]
    with pytest.raises(UnknownTarget, match="kairoz"):
        pairings(("cpsat", "pddl21"), ("kairoz", "auto"))
    with pytest.raises(OptionError, match="'cpsat' has none of the engines kairos"):
        pairings(("cpsat", "pddl21"), ("kairos",))


def test_a_missing_engine_and_a_wrong_option_are_reported_before_anything_is_solved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from irc_pddl21.engines import Optic

    monkeypatch.setattr(Optic, "missing", lambda self: "no optic here")
    with pytest.raises(EngineMissing, match="no optic here"):
        Batch([chain(1)], options(targets=("pddl21",), engines=("optic",)))
    with pytest.raises(UnknownTarget, match="input format"):
        InputOptions("asyncplam")
    with pytest.raises(OptionError, match="processes"):
        BatchOptions(processes=0)
    with pytest.raises(OptionError, match="time_limit"):
        TrialOptions(time_limit=0)


def hard(folder: Path, name: str) -> Path:
    """A file with a shop that nobody proves."""
    text = json.dumps(shop().model_dump(mode="json", by_alias=True, exclude_unset=True))
    path = folder / f"{name}.json"
    path.write_text(text, "utf-8")
    return path


def workers() -> list[int]:
    """The worker processes of this process."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == os.getpid() and b"irc.batches.worker" in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except (OSError, ValueError):
            continue
    return found


def wait_for_worker(other_than: set[int]) -> int:
    """The number of a worker that is new."""
    until = time.monotonic() + 30
    while not (new := {*workers()} - other_than):
        assert time.monotonic() < until
        time.sleep(0.02)
    return new.pop()


linux = pytest.mark.skipif(sys.platform != "linux", reason="it looks into /proc")


@pytest.mark.slow
@linux
def test_a_task_that_takes_two_workers_with_it_has_failed_and_the_rest_goes_on(
    tmp_path: Path,
) -> None:
    first = hard(tmp_path, "a")
    write(tmp_path, b=chain(4))

    def kill_two() -> None:
        killed: set[int] = set()
        for _ in range(2):
            worker = wait_for_worker(killed)
            time.sleep(0.2)
            os.kill(worker, signal.SIGKILL)
            killed.add(worker)

    killer = threading.Thread(target=kill_two)
    killer.start()
    limit = TrialOptions(time_limit=20)
    results = list(Batch([first, tmp_path / "b.json"], options(trial=limit)))
    killer.join()
    assert by_name(results) == {"a.json": ["failed"], "b.json": ["optimal"]}
    assert "was ended by SIGKILL" in results[0].outcome.message
    assert workers() == []


@pytest.mark.slow
@linux
def test_a_worker_that_goes_on_far_beyond_the_limit_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from irc.batches import local

    monkeypatch.setattr(local, "OVERTIME_FACTOR", 0.0)
    monkeypatch.setattr(local, "OVERTIME_SECONDS", 0.3)
    (result,) = Batch([hard(tmp_path, "a")], options(trial=TrialOptions(time_limit=20)))
    assert result.status == "failed"
    assert "did not end within 0.3 s" in result.outcome.message
    assert workers() == []


@pytest.mark.slow
@linux
def test_a_cancelled_batch_ends_with_whole_lines_and_leaves_no_process(tmp_path: Path) -> None:
    write(tmp_path, a=chain(4))
    output, cancel = tmp_path / "results.jsonl", Cancellation()
    inputs = [tmp_path / "a.json", hard(tmp_path, "b"), hard(tmp_path, "c")]
    batch = Batch(inputs, options(output, cancel=cancel))
    found = []
    for result in batch:
        found.append(result.task)
        cancel.cancel()
    assert [Path(task).name for task in found] == ["a.json"]
    assert [r.task for r in lines_of(output)] == found
    assert workers() == []
    # So does one that is left before its end.
    for _ in irc.batch(inputs, processes=1):
        break
    assert workers() == []


@pytest.mark.slow
@linux
def test_workers_that_are_ended_leave_no_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A planner's files lie in a folder that its worker would remove, if it were not ended."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    write(tmp_path, a=chain(4))
    cancel = Cancellation()
    inputs = [tmp_path / "a.json", hard(tmp_path, "b")]
    seen: list[str] = []
    planning = threading.Event()

    def look() -> None:
        while not planning.wait(0.02):
            seen.extend(str(path) for path in scratch.rglob("domain.pddl"))
            if seen:
                cancel.cancel()
                return

    looking = threading.Thread(target=look)
    looking.start()
    for _ in irc.batch(inputs, targets=["pddl21"], processes=1, cancel=cancel, time_limit=20):
        pass
    planning.set()
    looking.join()
    assert seen
    assert list(scratch.iterdir()) == []
    assert workers() == []


def result(
    task: str, engine: str, status: str, seconds: float, *values: tuple[str, int, int | None]
) -> BatchResult:
    """A result of `cpsat`, with (name, value, bound) of each objective."""
    document = {
        "irc_result": "1",
        "task": task,
        "sha256": task,
        "target": "cpsat",
        "engine": engine,
        "options": {},
        "outcome": irc.Outcome.of(status, (), "…").to_dict(),
        "objective": [dict(zip(("name", "value", "bound"), v, strict=True)) for v in values],
        "seconds": seconds,
    }
    return read_result(json.dumps(document))


def test_the_summary_counts_what_each_engine_solved_proved_and_how_well() -> None:
    from irc.batches.cactus import cactus_svg, cactus_text
    from irc.batches.summary import Summary

    summary = Summary(
        [
            result("x", "a", "unknown", 9),  # (the last result of a trial counts)
            result("x", "a", "optimal", 1, ("makespan", 10, 10)),
            result("y", "a", "feasible", 3, ("reward", 6, 8), ("makespan", 5, None)),
            result("z", "a", "infeasible", 2),
            result("x", "b", "feasible", 0.5, ("makespan", 12, 10)),
            result("y", "b", "optimal", 7, ("reward", 8, 8), ("makespan", 9, 9)),
            result("z", "b", "failed", 0),
        ]
    )
    a, b = summary.rows
    assert (a.tasks, a.solved, a.proven, a.infeasible, a.best, a.failed) == (3, 2, 2, 1, 1, 0)
    assert (b.tasks, b.solved, b.proven, b.infeasible, b.best, b.failed) == (3, 2, 1, 0, 1, 1)
    assert (a.median_seconds, a.total_seconds, a.times) == (2, 6, (1, 2, 3))
    assert (a.mean_gap, b.mean_gap) == (0.125, round((2 / 12) / 2, 6))
    assert str(summary).splitlines()[0].split()[:6] == [
        *("target", "engine", "tasks", "solved", "proven", "infeasible")
    ]
    assert "3 solved" in cactus_text(summary.rows)
    picture = cactus_svg(summary.rows)
    assert picture.count("<polyline") == 2
    assert cactus_text(Summary([result("z", "b", "failed", 0)]).rows) == ""
    assert str(Summary()) == "there are no results"


def test_a_result_is_the_same_after_writing_and_reading() -> None:
    for one in (
        result("x", "a", "feasible", 0.25, ("tardiness", 3, None), ("makespan", 10, 7)),
        result("\u2028\n", "a", "refused", 1),
    ):
        assert one.line().count("\n") == 1
        assert read_result(one.line()) == one
    for wrong in ("[]", "{}", '{"irc_result": "1"}', '{"irc_result": "2", "task": "a"}', "x"):
        with pytest.raises(ValueError):
            read_result(wrong)
