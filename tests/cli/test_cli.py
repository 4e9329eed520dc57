"""The command line: exit statuses, what goes to which stream, and files that appear whole."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.frontends.formats import IMPORTERS
from irc.model.features import Feature
from runs import run_irc

KITCHEN: dict[str, Any] = {
    "name": "café",
    "resources": [{"id": "oven"}, {"id": "pan"}],
    "actions": [
        {"id": "bread", "duration": 3, "uses": [{"resource": "oven"}]},
        {"id": "roast", "duration": 4, "uses": [{"resource": "oven"}]},
        {"id": "eggs", "duration": 2, "uses": [{"one_of": ["pan", "oven"]}]},
        {"id": "sauce", "duration": 2, "uses": [{"one_of": ["pan", "oven"]}]},
    ],
    "precedence": [["bread", "eggs"]],
}
KITCHEN_MAKESPAN = 7

# A list schedule takes the longest tail first, and misses the deadline.
UNRULY: dict[str, Any] = {
    "resources": [{"id": "oven"}],
    "actions": [
        {"id": "long", "duration": 5, "uses": [{"resource": "oven"}]},
        {"id": "tail", "duration": 20},
        {"id": "late", "duration": 2, "deadline": 2, "uses": [{"resource": "oven"}]},
    ],
    "precedence": [["long", "tail"]],
}

# Two weeks' work for one oven in a week: no check says so, a solver proves it.
OVERFULL: dict[str, Any] = {
    "resources": [{"id": "oven"}],
    "actions": [
        {"id": c, "duration": 3, "deadline": 5, "uses": [{"resource": "oven"}]} for c in "ab"
    ],
}

STATEFUL: dict[str, Any] = {
    "state": [{"id": "lit"}],
    "actions": [
        {"id": "light", "duration": 1, "effects": [{"at": "end", "var": "lit", "value": True}]}
    ],
    "groups": [{"id": "order", "actions": ["light"]}],
    "goals": [{"var": "lit"}],
}


posix = pytest.mark.skipif(os.name != "posix", reason="a shell script, or permissions, of POSIX")


def run_apart(*arguments: str | Path, **options: Any) -> subprocess.CompletedProcess[bytes]:
    """The command in a process of its own."""
    command = [sys.executable, "-m", "irc", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, timeout=120, check=False, **options)


def written(folder: Path, document: Any, name: str = "task.json") -> Path:
    path = folder / name
    path.write_text(json.dumps(document), "utf-8")
    return path


@pytest.fixture
def kitchen(tmp_path: Path) -> Path:
    return written(tmp_path, KITCHEN)


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    return written(tmp_path, {"actions": [{"id": "a", "duration": -1}]}, "bad.json")


def files_in(folder: Path) -> dict[str, str]:
    return {p.name: p.read_text("utf-8") for p in folder.iterdir()}


# Exit statuses and streams


def test_a_good_task_passes_the_check(kitchen: Path) -> None:
    result = run_irc("check", kitchen)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "no problems found\n", "")


def test_warnings_do_not_fail_a_check(tmp_path: Path) -> None:
    task = written(tmp_path, {**KITCHEN, "resources": [*KITCHEN["resources"], {"id": "cellar"}]})
    result = run_irc("check", task, "--format", "json")
    report = json.loads(result.stdout)
    assert (result.exit_code, report["ok"]) == (0, True)
    assert [d["code"] for d in report["diagnostics"]] == ["IRC401"]


@pytest.mark.parametrize(
    "command",
    [
        ["check"],
        ["compile", "-t", "cpsat"],
        ["compile", "-t", "pddl21"],
        ["solve"],
        ["solve", "-t", "pddl21"],
    ],
)
def test_a_fault_of_the_input_is_status_1_in_every_command(bad: Path, command: list[str]) -> None:
    result = run_irc(*command, bad)
    assert result.exit_code == 1
    told, silent = (
        (result.stdout, result.stderr) if command == ["check"] else (result.stderr, result.stdout)
    )
    assert f"error[IRC105]: the duration of action 'a' is negative: -1\n  --> {bad}:1:" in told
    assert "1 error" in told
    assert silent == ""


@pytest.mark.parametrize("command", [["check"], ["compile", "-t", "cpsat"], ["solve"]])
def test_json_is_alone_on_stdout_where_the_input_is_at_fault(bad: Path, command: list[str]) -> None:
    result = run_irc(*command, bad, "--format", "json")
    document = json.loads(result.stdout)
    assert (result.exit_code, result.stderr, document["ok"]) == (1, "", False)
    (diagnostic,) = document["diagnostics"]
    assert set(diagnostic) == {
        "code",
        "severity",
        "message",
        "pointer",
        "line",
        "column",
        "hint",
        "fix",
    }
    assert (diagnostic["code"], diagnostic["pointer"]) == ("IRC105", "/actions/0/duration")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["compile", "FILE", "-t", "cpsatt"], "there is no target 'cpsatt'; did you mean `cpsat`?"),
        (["solve", "FILE", "-t", "pddl"], "there is no target 'pddl'; did you mean `pddl21`?"),
        (["solve", "FILE", "-t", "minizinc"], "known are cpsat, pddl21"),
        (["solve", "FILE", "-e", "ortool"], "there is no engine 'ortool'; did you mean `ortools`?"),
        (["solve", "FILE", "-t", "pddl21", "-e", "kairo"], "did you mean `kairos`?"),
        (["convert", "FILE", "-o", "x", "--from", "asyncplans"], "did you mean `asyncplan`?"),
        (["validate", "-", "-"], "only one of the two can be standard input"),
        (["extract", "-", "-"], "only one of the two can be standard input"),
    ],
)
def test_wrong_use_is_status_2_with_a_way_out(
    kitchen: Path, arguments: list[str], said: str
) -> None:
    arguments = [str(kitchen) if a == "FILE" else a for a in arguments]
    result = run_irc(*arguments, stdin="{}")
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr
    result = run_irc(*arguments, "--format", "json", stdin="{}")
    document = json.loads(result.stdout)
    assert (result.exit_code, document["exit"], document["irc_error"]) == (2, 2, "1")
    assert said in document["message"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["chek", "FILE"],
        ["check"],
        ["compile", "FILE"],
        ["check", "FILE", "--verbose"],
        ["check", "FILE", "--format", "yaml"],
        ["solve", "FILE", "--time-limit", "0"],
        ["solve", "FILE", "--time-limit", "nan"],
        ["solve", "FILE", "--time-limit", "inf"],
        ["solve", "FILE", "--memory-limit", "99999999999999999999"],
        ["solve", "FILE", "--workers", "0"],
        ["solve", "FILE", "--workers", "99999999999999999999"],
        ["solve", "FILE", "--seed", "-1"],
        ["solve", "FILE", "--seed", "4294967296"],
    ],
)
def test_arguments_that_do_not_exist_or_fit_are_status_2(
    kitchen: Path, arguments: list[str]
) -> None:
    result = run_irc(*(str(kitchen) if a == "FILE" else a for a in arguments))
    assert (result.exit_code, result.stdout) == (2, "")
    assert "Usage:" in result.stderr


@pytest.mark.slow
@pytest.mark.parametrize("option", [["--workers", "10000"], ["--memory-limit", "1073741824"]])
@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_the_largest_limits_that_are_taken_do_no_harm(
    kitchen: Path, option: list[str], target: str
) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
        option = [*option, "-e", "kairos"]
    assert run_irc("solve", kitchen, "-t", target, *option).exit_code == 0


def test_an_infeasible_task_is_status_1(tmp_path: Path) -> None:
    result = run_irc("solve", written(tmp_path, OVERFULL), "--format", "json")
    document = json.loads(result.stdout)
    assert (result.exit_code, document["status"], document["actions"]) == (1, "infeasible", [])


@pytest.fixture
def silent_optic(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A planner that finds no plan."""
    silent = tmp_path / "optic"
    silent.write_text("#!/bin/sh\nexit 0\n")
    silent.chmod(0o755)
    monkeypatch.setenv("IRC_OPTIC", str(silent))


@posix
@pytest.mark.usefixtures("silent_optic")
@pytest.mark.parametrize(
    ("document", "ends"),
    [(UNRULY, (3, "unknown", "optic")), (KITCHEN, (0, "optimal", "list-schedule"))],
    ids=["no answer within the limits is status 3", "the compiler's own schedule is an answer"],
)
def test_a_planner_that_finds_no_plan(
    tmp_path: Path, document: dict[str, Any], ends: tuple[int, str, str]
) -> None:
    task = written(tmp_path, document)
    result = run_irc("solve", task, "-t", "pddl21", "-e", "optic", "--format", "json")
    shown = json.loads(result.stdout)
    assert (result.exit_code, shown["status"], shown.get("engine")) == ends
    assert "optic: there is no plan in the text" in result.stderr


def test_a_missing_engine_is_status_4(kitchen: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IRC_OPTIC", "/nowhere/optic-clp")
    result = run_irc("solve", kitchen, "-t", "pddl21", "-e", "optic")
    assert (result.exit_code, result.stdout) == (4, "")
    assert "$IRC_OPTIC names '/nowhere/optic-clp', no such command" in result.stderr
    result = run_irc("solve", kitchen, "-t", "pddl21", "-e", "optic", "--format", "json")
    assert (result.exit_code, json.loads(result.stdout)["exit"]) == (4, 4)


@posix
def test_an_engine_that_breaks_down_is_status_4(
    kitchen: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "optic"
    broken.write_text("#!/bin/sh\necho 'no licence' >&2\nexit 9\n")
    broken.chmod(0o755)
    monkeypatch.setenv("IRC_OPTIC", str(broken))
    result = run_irc("solve", kitchen, "-t", "pddl21", "-e", "optic")
    assert (result.exit_code, result.stdout) == (4, "")
    assert "optic failed with exit status 9: no licence" in result.stderr


def test_the_version_is_that_of_the_package() -> None:
    result = run_irc("--version")
    assert (result.exit_code, result.stdout) == (0, f"irc {irc.__version__}\n")


# Standard input


@pytest.mark.parametrize(
    "command", [["check"], ["compile", "-t", "pddl21"], ["compile", "-t", "cpsat"], ["solve"]]
)
def test_a_dash_is_standard_input(kitchen: Path, command: list[str]) -> None:
    from_file = run_irc(*command, kitchen, "--format", "json")
    from_stdin = run_irc(*command, "-", "--format", "json", stdin=kitchen.read_bytes())
    assert from_stdin.exit_code == 0
    one, other = json.loads(from_stdin.stdout), json.loads(from_file.stdout)
    for document in (one, other):
        document.pop("seconds", None)
    assert one == other


def test_faults_on_standard_input_have_places(bad: Path) -> None:
    result = run_irc("check", "-", stdin=bad.read_bytes())
    assert result.exit_code == 1
    assert "--> <stdin>:1:" in result.stdout


def test_a_schedule_may_come_from_standard_input(kitchen: Path) -> None:
    schedule = run_irc("solve", kitchen, "--format", "json").stdout
    assert run_irc("validate", kitchen, "-", stdin=schedule).exit_code == 0


# compile


def test_compile_prints_the_text_where_no_folder_is_named(kitchen: Path) -> None:
    program = irc.compile(KITCHEN, "pddl21")
    result = run_irc("compile", kitchen, "-t", "pddl21")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == "".join(f"; {name}\n{text}" for name, text in program.files.items())
    (model,) = irc.compile(KITCHEN, "cpsat").files.values()
    assert run_irc("compile", kitchen, "-t", "cpsat").stdout == model.removesuffix("\n") + "\n"


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_compile_writes_the_files_and_the_manifest(
    kitchen: Path, tmp_path: Path, target: str
) -> None:
    program = irc.compile(KITCHEN, target)
    folder = tmp_path / "a" / "new" / "folder"
    result = run_irc("compile", kitchen, "-t", target, "-o", folder)
    assert (result.exit_code, result.stdout) == (0, "")
    assert files_in(folder) == {**program.files, "manifest.json": program.manifest_text()}
    assert str(folder) in result.stderr


def test_compile_as_json_tells_what_was_written(kitchen: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    result = run_irc("compile", kitchen, "-t", "pddl21", "-o", folder, "--format", "json")
    document = json.loads(result.stdout)
    assert document["folder"] == str(folder)
    assert sorted(document["files"]) == sorted(files_in(folder))
    document = json.loads(run_irc("compile", kitchen, "-t", "pddl21", "--format", "json").stdout)
    assert document["files"] == dict(irc.compile(KITCHEN, "pddl21").files)
    assert document["manifest"] == irc.compile(KITCHEN, "pddl21").manifest


def test_compiling_twice_writes_the_same_bytes(kitchen: Path, tmp_path: Path) -> None:
    for name in ("one", "two"):
        run_irc("compile", kitchen, "-t", "pddl21", "-o", tmp_path / name)
    assert files_in(tmp_path / "one") == files_in(tmp_path / "two")


# Files appear whole or not at all


@pytest.mark.parametrize("command", [["compile", "-t", "pddl21"], ["solve"]])
def test_what_cannot_be_written_is_status_2(
    kitchen: Path, tmp_path: Path, command: list[str]
) -> None:
    """A folder below a file cannot be made, not even by root."""
    result = run_irc(*command, kitchen, "-o", kitchen / "below" / "it")
    assert result.exit_code == 2
    assert f"cannot {'make folder' if command[0] == 'compile' else 'write'} " in result.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["task.json"]


def test_a_schedule_is_not_written_over_a_folder(kitchen: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    result = run_irc("solve", kitchen, "-o", folder)
    assert result.exit_code == 2
    assert f"cannot write '{folder}'" in result.stderr
    assert files_in(folder) == {}
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out", "task.json"]


@pytest.mark.parametrize("command", [["compile", "-t", "cpsat"], ["solve"], ["convert"]])
def test_a_faulty_task_leaves_no_file(bad: Path, tmp_path: Path, command: list[str]) -> None:
    if command == ["convert"]:
        bad.write_text("{")
    assert run_irc(*command, bad, "-o", tmp_path / "out").exit_code == 1
    assert [p.name for p in tmp_path.iterdir()] == ["bad.json"]


def test_a_failed_write_leaves_the_old_file_as_it_was(
    kitchen: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "schedule.json"
    out.write_text("old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    result = run_irc("solve", kitchen, "-o", out)
    assert result.exit_code == 2
    assert "No space left on device" in result.stderr
    assert out.read_text() == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["schedule.json", "task.json"]


@posix
def test_a_written_file_has_the_permissions_of_any_new_file(kitchen: Path, tmp_path: Path) -> None:
    out, other = tmp_path / "schedule.json", tmp_path / "other"
    run_irc("solve", kitchen, "-o", out)
    other.touch()
    assert out.stat().st_mode == other.stat().st_mode


# solve


def test_solve_prints_the_schedule_document(kitchen: Path) -> None:
    result = run_irc("solve", kitchen, "--format", "json")
    assert (result.exit_code, result.stderr) == (0, "")
    document = json.loads(result.stdout)
    assert set(document) == {
        "irc_schedule",
        "task",
        "task_sha256",
        "time_unit",
        "status",
        "makespan",
        "objective",
        "actions",
        "target",
        "engine",
        "seconds",
    }
    assert document["irc_schedule"] == "1"
    assert (document["task"], document["status"], document["makespan"]) == ("café", "optimal", 7)
    assert document["objective"] == [{"name": "makespan", "value": 7, "bound": 7}]
    assert (document["target"], document["engine"]) == ("cpsat", "ortools")
    bread = next(a for a in document["actions"] if a["id"] == "bread")
    assert bread["end"] - bread["start"] == 3
    assert bread["resources"] == {"oven": 1}


def test_solve_writes_the_document_it_prints(kitchen: Path, tmp_path: Path) -> None:
    out = tmp_path / "schedule.json"
    result = run_irc("solve", kitchen, "-o", out, "--format", "json")
    assert json.loads(out.read_text("utf-8")) == json.loads(result.stdout)


def test_solve_shows_people_each_action_and_says_where_it_wrote(
    kitchen: Path, tmp_path: Path
) -> None:
    out = tmp_path / "schedule.json"
    result = run_irc("solve", kitchen, "-o", out)
    assert result.exit_code == 0
    assert all(action["id"] in result.stdout for action in KITCHEN["actions"])
    assert "optimal" in result.stdout
    assert result.stderr == f"wrote {out}\n"


def test_without_contention_no_solver_is_asked_unless_told(tmp_path: Path) -> None:
    task = written(tmp_path, {"actions": [{"id": "a", "duration": "1/3"}]})
    quick = json.loads(run_irc("solve", task, "--format", "json").stdout)
    assert (quick["engine"], quick["makespan"], quick["status"]) == (
        "critical-path",
        "1/3",
        "optimal",
    )
    asked = json.loads(run_irc("solve", task, "--no-shortcut", "--format", "json").stdout)
    assert (asked["engine"], asked["makespan"]) == ("ortools", "1/3")


# extract


def cp_sat_response(folder: Path) -> str:
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    assert model.proto.parse_text_format((folder / "model.pbtxt").read_text("utf-8"))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    assert solver.solve(model) == cp_model.OPTIMAL
    return str(solver.response_proto)


def kairos_output(folder: Path) -> str:
    kairos = pytest.importorskip("kairos")
    domain = kairos.parse_domain((folder / "domain.pddl").read_text("utf-8"))
    problem = kairos.parse_problem((folder / "problem.pddl").read_text("utf-8"), domain)
    plans = list(kairos.Planner().plans(problem, timeout=20.0, target_cost=KITCHEN_MAKESPAN + 0.5))
    return "searching …\n" + "\n\n".join(map(str, plans))


ENGINES = {"cpsat": cp_sat_response, "pddl21": kairos_output}


@pytest.mark.slow
@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_extract_reads_what_an_engine_made_of_the_files(
    kitchen: Path, tmp_path: Path, target: str
) -> None:
    folder = tmp_path / "program"
    run_irc("compile", kitchen, "-t", target, "-o", folder)
    answer = tmp_path / "answer.txt"
    answer.write_text(ENGINES[target](folder), "utf-8")
    kitchen.unlink()  # the manifest is enough
    out = tmp_path / "schedule.json"
    result = run_irc("extract", folder / "manifest.json", answer, "-o", out, "--format", "json")
    assert (result.exit_code, result.stderr) == (0, "")
    document = json.loads(result.stdout)
    assert json.loads(out.read_text("utf-8")) == document
    assert (document["task"], document["target"]) == ("café", target)
    # It meets the bound that irc has computed, which is a proof.
    assert (document["makespan"], document["status"]) == (KITCHEN_MAKESPAN, "optimal")
    task = written(tmp_path, KITCHEN)
    assert run_irc("validate", task, out).exit_code == 0
    piped = run_irc("extract", folder / "manifest.json", "-", stdin=answer.read_bytes())
    assert piped.exit_code == 0


@pytest.fixture
def manifest(kitchen: Path, tmp_path: Path) -> Path:
    run_irc("compile", kitchen, "-t", "pddl21", "-o", tmp_path)
    return tmp_path / "manifest.json"


@pytest.mark.parametrize("answer", ["", "no plan here", "0.000: (bread)  [3.000]\n", "\x00\xff"])
def test_an_answer_without_a_whole_plan_is_status_1(manifest: Path, answer: str) -> None:
    result = run_irc("extract", manifest, "-", stdin=answer)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "error[IRC602]" in result.stderr


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("irc_manifest", "9", "'irc_manifest' must be '1'"),
        ("task", None, "the manifest lacks"),
        ("names", [], "the manifest lacks"),
        ("task_sha256", "0" * 64, "the manifest was changed"),
        ("task", {"actions": [{"id": "a", "duration": -1}]}, "the manifest was changed"),
    ],
)
def test_a_manifest_that_is_none_or_was_changed_is_status_1(
    manifest: Path, field: str, value: object, said: str
) -> None:
    document = {**json.loads(manifest.read_text("utf-8")), field: value}
    manifest.write_text(json.dumps(document), "utf-8")
    result = run_irc("extract", manifest, "-", stdin="")
    assert (result.exit_code, result.stdout) == (1, "")
    assert said in result.stderr


@pytest.mark.parametrize(
    ("target", "names"),
    [
        ("pddl21", {}),
        ("pddl21", {"planner_units_per_tick": 1}),
        ("pddl21", {"planner_units_per_tick": 1, "actions": {"bread": 5}, "planner_only": {}}),
        ("cpsat", {"actions": []}),
        ("cpsat", {"actions": {"bread": {"start": None}}}),
    ],
)
def test_a_manifest_with_damaged_names_is_status_1(
    kitchen: Path, tmp_path: Path, target: str, names: object
) -> None:
    run_irc("compile", kitchen, "-t", target, "-o", tmp_path)
    answer = ENGINES[target](tmp_path)
    manifest = tmp_path / "manifest.json"
    document = {**json.loads(manifest.read_text("utf-8")), "names": names}
    manifest.write_text(json.dumps(document), "utf-8")
    result = run_irc("extract", manifest, "-", stdin=answer)
    assert (result.exit_code, result.stdout) == (1, "")


def test_a_response_that_chooses_nothing_is_status_1(kitchen: Path, tmp_path: Path) -> None:
    run_irc("compile", kitchen, "-t", "cpsat", "-o", tmp_path)
    response = "status: FEASIBLE\n" + "solution: 0\n" * 50
    result = run_irc("extract", tmp_path / "manifest.json", "-", stdin=response)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "error[IRC602]" in result.stderr


def test_an_answer_that_no_valid_schedule_stands_behind_is_status_1(manifest: Path) -> None:
    actions = json.loads(manifest.read_text("utf-8"))["names"]["actions"]
    first = {entry["action"]: name for name, entry in reversed(actions.items())}
    plan = "".join(f"0.000: ({name})  [4.000]\n" for name in first.values())
    result = run_irc("extract", manifest, "-", stdin=plan)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "oven" in result.stderr


# validate


def test_validate_accepts_what_solve_wrote(kitchen: Path, tmp_path: Path) -> None:
    out = tmp_path / "schedule.json"
    run_irc("solve", kitchen, "-o", out)
    result = run_irc("validate", kitchen, out)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == "valid: makespan 7 s\n"
    verdict = json.loads(run_irc("validate", kitchen, out, "--format", "json").stdout)
    assert (verdict["valid"], verdict["makespan"], verdict["violations"]) == (True, 7, [])


def test_validate_rejects_with_reasons(kitchen: Path, tmp_path: Path) -> None:
    entries = [("bread", 0, 3, "oven"), ("roast", 2, 6, "oven"), ("eggs", 2, 4, "pan")]
    actions = [{"id": i, "start": s, "end": e, "resources": {r: 1}} for i, s, e, r in entries]
    schedule = {"actions": actions}
    out = written(tmp_path, schedule, "schedule.json")
    result = run_irc("validate", kitchen, out)
    assert (result.exit_code, result.stderr) == (1, "")
    verdict = json.loads(run_irc("validate", kitchen, out, "--format", "json").stdout)
    assert not verdict["valid"]
    rules = {v["rule"]: v["message"] for v in verdict["violations"]}
    assert "'sauce'" in rules["presence"]
    assert "'oven'" in rules["capacity"]
    assert "'eggs' starts at 2 s" in rules["precedence"]
    for message in rules.values():
        assert message in result.stdout


def test_validate_as_of_a_time_carries_what_only_history_causes(tmp_path: Path) -> None:
    document = {"actions": [{"id": "a", "duration": 3, "deadline": 2}], "time_unit": "min"}
    task = written(tmp_path, document, "task.json")
    entries = {"actions": [{"id": "a", "start": 0, "end": 3}]}
    schedule = written(tmp_path, entries, "schedule.json")
    result = run_irc("validate", task, schedule, "--at", "90 s")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "note: 1 violation carried, caused only by entries that began before 1.5 min:" in (
        result.stdout
    )
    assert run_irc("validate", task, schedule, "--at", "0").exit_code == 1
    verdict = json.loads(
        run_irc("validate", task, schedule, "--at", "1.5", "--format", "json").stdout
    )
    assert (verdict["valid"], verdict["at"]) == (True, 1.5)
    assert [v["rule"] for v in verdict["carried"]] == ["deadline"]
    result = run_irc("validate", task, schedule, "--at", "soon")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--at" in result.stderr


def test_a_schedule_of_another_task_is_not_judged(kitchen: Path, tmp_path: Path) -> None:
    out = tmp_path / "schedule.json"
    run_irc("solve", kitchen, "-o", out)
    kitchen.write_text(json.dumps({**KITCHEN, "precedence": []}))
    result = run_irc("validate", kitchen, out)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "made for another task" in result.stderr


@pytest.mark.parametrize(
    "schedule",
    ["", "[]", "{}", '{"actions": 1}', '{"actions": [{"id": "bread", "start": "soon", "end": 3}]}'],
)
def test_a_schedule_that_is_none_is_status_1(kitchen: Path, schedule: str) -> None:
    result = run_irc("validate", kitchen, "-", stdin=schedule)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "error[IRC" in result.stderr


# convert


ASYNCPLAN = [
    {
        "id": 7,
        "question": "To brew tea, here are the steps needed.\nStep 1. Boil the water (2 minutes)\n"
        "Step 2. Warm the pot (30 seconds)\nStep 3. Steep (3 minutes)\n\nStep 1 must precede …",
        "task_title": "brew tea",
        "answer": 300,
        "n_steps": 3,
        "graph": {
            "edges": [[0, 2], [1, 2]],
            "durations": [120, 30, 180],
            "step_to_node": {"1": 0, "2": 1, "3": 2},
        },
    },
    {
        "id": 8,
        "question": "",
        "task_title": "rest",
        "n_steps": 1,
        "graph": {"edges": [], "durations": [60], "step_to_node": {"1": 0}},
    },
]


def test_convert_writes_one_task_for_each_instance(tmp_path: Path) -> None:
    folder = tmp_path / "tasks"
    source = written(tmp_path, ASYNCPLAN, "asyncplan.json")
    result = run_irc("convert", source, "-o", folder, "--from", "asyncplan")
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr == f"wrote 2 tasks to {folder}\n"
    assert sorted(files_in(folder)) == ["nodes1_8.json", "nodes3_7.json"]
    tea = irc.load(folder / "nodes3_7.json").ir
    assert (tea.name, tea.metadata) == ("brew tea", {"id": 7, "answer": 300})
    assert {a.id: (a.label, a.duration) for a in tea.actions} == {
        "step1": ("Boil the water", 120),
        "step2": ("Warm the pot", 30),
        "step3": ("Steep", 180),
    }
    assert sorted((e.before, e.after) for e in tea.precedence) == [
        ("step1", "step3"),
        ("step2", "step3"),
    ]
    assert irc.solve(tea).makespan == 300


@pytest.mark.parametrize(
    "source",
    [
        "",
        "{",
        "3",
        "[3]",
        '[{"graph": 3}]',
        '[{"graph": {"durations": [1], "edges": [[0, 5]], "step_to_node": {"1": 0}}}]',
        '[{"graph": {"durations": [1], "edges": [3], "step_to_node": {"1": 0}}}]',
        '[{"graph": {"durations": [1], "edges": [], "step_to_node": {"1": [0]}}}]',
        '[{"graph": {"durations": [1], "edges": [], "step_to_node": {"1": "0"}}}]',
        '[{"graph": {"durations": 1, "edges": []}}]',
        '[{"graph": {"durations": ["x"], "edges": [], "step_to_node": {"1": 0}}}]',
        "[" * 100_000,
        '[{"graph": {"durations": [NaN], "edges": []}}]',
    ],
)
def test_what_is_no_asyncplan_is_status_1_and_writes_nothing(tmp_path: Path, source: str) -> None:
    good = json.dumps(ASYNCPLAN[0])
    text = f"[{good}, {source[1:]}" if source.startswith("[{") else source
    file = tmp_path / "asyncplan.json"
    file.write_text(text)
    result = run_irc("convert", file, "-o", tmp_path / "out", "--from", "asyncplan")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "error[IRC107]" in result.stderr
    assert not (tmp_path / "out").exists()


def test_convert_keeps_what_a_task_says(kitchen: Path, tmp_path: Path) -> None:
    out = tmp_path / "converted.json"
    result = run_irc("convert", kitchen, "-o", out, "--format", "json")
    assert json.loads(result.stdout) == {"written": [str(out)]}
    assert irc.load(out).ir == irc.load(kitchen).ir


@pytest.mark.shared_data
def test_convert_takes_the_whole_benchmark(shared_data: Path, tmp_path: Path) -> None:
    assert "asyncplan" in IMPORTERS
    source = shared_data / "asyncplan_xxl" / "nodes10.json"
    instances = json.loads(source.read_text("utf-8"))
    result = run_irc("convert", source, "-o", tmp_path, "--from", "asyncplan")
    assert result.exit_code == 0
    tasks = [irc.load(path).ir for path in tmp_path.iterdir()]
    assert len(tasks) == len(instances)
    assert sorted(t.metadata["id"] for t in tasks) == sorted(i["id"] for i in instances)
    assert {t.metadata["id"]: len(t.precedence) for t in tasks} == {
        i["id"]: len(i["graph"]["edges"]) for i in instances
    }
    assert all(irc.solve(task).status == "optimal" for task in tasks[:10])


# targets


def test_targets_shows_every_feature_and_engine() -> None:
    result = run_irc("targets")
    assert (result.exit_code, result.stderr) == (0, "")
    assert all(feature.value in result.stdout for feature in Feature)
    document = json.loads(run_irc("targets", "--format", "json").stdout)
    assert set(document) == {"cpsat", "pddl21"}
    assert {f.name.lower() for f in Feature} == set(document["cpsat"]["features"])
    assert set(document["pddl21"]["engines"]) == {"auto", "optic", "kairos", "aries"}


def test_targets_says_why_an_engine_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IRC_OPTIC", "/nowhere/optic-clp")
    assert "optic (missing)" in run_irc("targets").stdout
    engines = json.loads(run_irc("targets", "--format", "json").stdout)["pddl21"]["engines"]
    assert engines["optic"]["available"] is False
    assert "/nowhere/optic-clp" in engines["optic"]["reason"]


def test_targets_with_a_file_says_who_takes_it(kitchen: Path) -> None:
    result = run_irc("targets", kitchen)
    assert result.exit_code == 0
    assert "cpsat supports this file" in result.stdout
    assert "pddl21 supports this file" in result.stdout
    assert Feature.RESERVOIRS.value not in result.stdout  # it has none


def test_targets_with_a_file_says_why_not(tmp_path: Path) -> None:
    """Holds for every backend, whatever it has learnt to take."""
    task = written(tmp_path, STATEFUL)
    document = json.loads(run_irc("targets", task, "--format", "json").stdout)
    used = {"state", "effects", "groups", "state_goals", "makespan"}
    assert set(document["cpsat"]["features"]) == used
    text = run_irc("targets", task).stdout
    for name, target in document.items():
        refused = {r["feature"]: r["pointer"] for r in target["refused"]}
        assert target["supports_file"] is (not refused)
        assert set(refused) == {f for f, able in target["features"].items() if not able}
        assert (f"{name} supports this file" in text) is (not refused)
        for feature, pointer in refused.items():
            assert f"({pointer}): {Feature[feature.upper()].value}" in text


def test_a_target_refuses_with_the_feature_its_place_and_who_can(tmp_path: Path) -> None:
    task = written(tmp_path, STATEFUL)
    targets = json.loads(run_irc("targets", task, "--format", "json").stdout)
    for name, target in targets.items():
        result = run_irc("compile", task, "-t", name, "-o", tmp_path / name, "--format", "json")
        assert result.exit_code == (1 if target["refused"] else 0)
        diagnostics = json.loads(result.stdout).get("diagnostics", [])
        assert [d["code"] for d in diagnostics] == ["IRC501"] * len(target["refused"])
        assert {d["pointer"] for d in diagnostics} == {r["pointer"] for r in target["refused"]}
        assert (tmp_path / name).exists() is (not target["refused"])
        for refused in target["refused"]:
            feature = Feature[refused["feature"].upper()]
            able = [n for n, t in targets.items() if t["features"][refused["feature"]]]
            refusal = f": target '{name}' does not support {feature.value}"
            (told,) = (d for d in diagnostics if d["message"].endswith(refusal))
            assert told["line"] is not None
            assert told["hint"] == (
                f"targets that support it: {', '.join(able)}"
                if able
                else "no installed target supports it yet"
            )


def test_a_refusal_names_the_targets_that_can(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from irc_cpsat import CpSat

    monkeypatch.setattr(CpSat, "supports", CpSat.supports - {Feature.RESOURCES})
    result = run_irc("solve", written(tmp_path, KITCHEN))
    assert result.exit_code == 1
    assert "target 'cpsat' does not support renewable resources" in result.stderr
    assert "hint: targets that support it: pddl21" in result.stderr


# schema


def test_the_schema_is_json_schema_of_the_ir() -> None:
    result = run_irc("schema")
    assert (result.exit_code, result.stderr) == (0, "")
    schema = json.loads(result.stdout)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert set(schema["properties"]) >= set(KITCHEN) | set(STATEFUL) | {"deadline", "events"}
    assert schema["additionalProperties"] is False
    window = schema["$defs"]["Window"]["properties"]
    assert {"from", "to", "capacity"} == set(window)  # the names of the document, not of Python
    pointers = set(json.dumps(schema).split('"#/$defs/')[1:])
    assert {p.split('"')[0] for p in pointers} <= set(schema["$defs"])


# In a process of its own


@pytest.mark.slow
def test_names_are_escaped_where_stdout_cannot_hold_them(kitchen: Path) -> None:
    kitchen.write_text(json.dumps({**KITCHEN, "name": "café 🤖"}), "utf-8")
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    text = run_apart("solve", kitchen, env=environment)
    assert text.returncode == 0
    assert text.stdout.isascii()
    assert b"caf\\xe9" in text.stdout
    document = run_apart("solve", kitchen, "--format", "json", env=environment)
    assert json.loads(document.stdout)["task"] == "café 🤖"


@pytest.mark.slow
def test_a_reader_that_goes_away_makes_no_traceback(kitchen: Path) -> None:
    command = [sys.executable, "-m", "irc", "schema"]
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, timeout=60, check=False)
    os.close(write)
    assert ended.stderr == b""


@pytest.mark.slow
def test_the_module_and_the_script_are_the_same_command(kitchen: Path) -> None:
    script = Path(sys.executable).with_name("irc")
    if not script.exists():
        pytest.skip("the script is not installed beside this Python")
    ended = subprocess.run(
        [script, "compile", kitchen, "-t", "pddl21"], capture_output=True, timeout=60, check=False
    )
    assert (ended.returncode, ended.stderr) == (0, b"")
    assert ended.stdout == run_apart("compile", kitchen, "-t", "pddl21").stdout
