"""Each way in which a call can end has one form: in JSON, in Python and in text (docs/outcomes.md).

The tasks here end in the same way, and another part of irc finds it out each time.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.cli import exit_codes
from irc.diagnostics import Code
from irc.outcome import EXIT_STATUS, Outcome
from irc.targets import SolveOptions
from runs import run_irc

OVEN: dict[str, Any] = {"resources": [{"id": "oven"}]}


def baking(name: str, *times: dict[str, Any], **more: Any) -> dict[str, Any]:
    actions = [
        {"id": f"a{k}", "uses": [{"resource": "oven"}], **fields} for k, fields in enumerate(times)
    ]
    return {"name": name, **OVEN, "actions": actions, **more}


INFEASIBLE: dict[str, dict[str, Any]] = {
    "dates, by the checks": baking("x", {"duration": 5, "release": 3, "deadline": 7}),
    "a cycle, by the checks": {
        **baking("x", {"duration": 5}, {"duration": 5}),
        "precedence": [["a0", "a1"], ["a1", "a0"]],
    },
    "state, by the checks": {
        "name": "x",
        "state": [{"id": "door", "values": ["open", "shut"], "initial": "shut"}],
        "actions": [{"id": "a0", "duration": 5}],
        "goals": [{"var": "door", "value": "open"}],
    },
    "a bound, by the passes": baking("x", {"duration": 5}, {"duration": 5}, deadline=9),
    "an order of stock": {
        "name": "x",
        "resources": [{"id": "flour", "kind": "reservoir", "capacity": 9, "initial": 1}],
        "actions": [
            {"id": "a0", "duration": 5, "consumes": [{"resource": "flour", "amount": 2}]},
        ],
    },
    "the oven, by the engine": baking(
        "x", {"duration": 4, "start": 3}, {"duration": 4, "deadline": 9}
    ),
}
REFUSED = {"name": "x", "actions": [{"id": "a0", "duration": 5, "due": 3}]}
REFUSED["objective"] = ["minimize_earliness"]
FAULTY = {"name": "x", "actions": [{"id": "a0", "duratio": 5}]}
PLAN = {"actions": [{"id": "a0", "start": 0, "end": 5}]}

OUTCOME_FIELDS = {"irc_outcome", "status", "exit", "message", "answered", "diagnostics"}
SCHEDULE_FIELDS = {
    *("irc_schedule", "task", "task_sha256", "time_unit", "status", "makespan", "objective"),
    *("actions", "target", "engine", "seconds", "outcome"),
}


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    def written(document: object, name: str = "task.json") -> Path:
        path = tmp_path / name
        path.write_text(json.dumps(document))
        return path

    return written


def ended(*arguments: object, stdin: str | None = None) -> tuple[int, dict[str, Any], str]:
    """(exit status, JSON document, the same command's text) of a command."""
    result = run_irc(*arguments, "--format", "json", stdin=stdin)
    text = run_irc(*arguments, stdin=stdin)
    assert text.exit_code == result.exit_code
    return result.exit_code, json.loads(result.stdout), text.stdout + text.stderr


def require(document: dict[str, Any], code: int, status: str) -> dict[str, Any]:
    """The outcome of a document, which must have the one form."""
    outcome: dict[str, Any] = document["outcome"]
    assert outcome.keys() == OUTCOME_FIELDS
    assert (outcome["status"], outcome["exit"]) == (status, code)
    assert (outcome["exit"], bool(outcome["message"])) == (EXIT_STATUS[status], True)
    return outcome


# --- infeasible ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", INFEASIBLE)
def test_an_infeasible_task_is_told_in_one_form_whoever_finds_it_out(
    name: str, write: Callable[..., Path]
) -> None:
    file = write(INFEASIBLE[name])
    code, document, text = ended("solve", file)
    outcome = require(document, 1, "infeasible")
    assert (code, document["status"], document.keys()) == (1, "infeasible", SCHEDULE_FIELDS)
    assert outcome["message"] == "no schedule exists"
    assert outcome["diagnostics"], "there is always a reason"
    for finding in outcome["diagnostics"]:
        assert f"error[{finding['code']}]: {finding['message']}" in text
        assert finding["code"].startswith("IRC3")
    assert "x  ✘ infeasible" in text
    schedule = irc.solve(INFEASIBLE[name], workers=1)
    assert schedule.status is irc.Status.INFEASIBLE
    assert (schedule.entries, schedule.outcome.status, schedule.outcome.exit) == (
        (),
        "infeasible",
        1,
    )
    codes = [finding["code"] for finding in outcome["diagnostics"]]
    assert [reason.code.id for reason in schedule.reasons] == codes
    assert irc.Schedule.from_dict(json.loads(json.dumps(schedule.to_dict()))) == schedule


@pytest.mark.parametrize("name", INFEASIBLE)
def test_simulate_explain_and_run_tell_it_as_solve_does(
    name: str, write: Callable[..., Path]
) -> None:
    file = write(INFEASIBLE[name])
    code, simulation, text = ended("simulate", file)
    first = require(simulation, 1, "infeasible")
    assert (code, simulation["steps"][0]["outcome"]) == (1, first)
    assert simulation["final"]["outcome"] == first
    assert first["diagnostics"]
    assert "infeasible" in text
    code, explanation, text = ended("explain", file)
    assert require(explanation, 1, "infeasible")["diagnostics"]
    assert (code, explanation["status"], explanation["feasible"]) == (1, "infeasible", False)
    assert "x: no schedule exists" in text
    run = run_irc("run", file, "--stdio")
    assert (run.exit_code, run.stdout) == (1, "")
    assert "there is no schedule to begin with: infeasible" in run.stderr


@pytest.mark.parametrize("name", [n for n in INFEASIBLE if "checks" in n])
def test_commands_that_give_no_schedule_report_it_as_diagnostics(
    name: str, write: Callable[..., Path]
) -> None:
    file = write(INFEASIBLE[name])
    for command in (("compile", file, "--target", "cpsat"), ("check", file)):
        code, document, text = ended(*command)
        outcome = require(document, 1, "infeasible")
        assert (code, document["ok"], document["diagnostics"]) == (
            1,
            False,
            outcome["diagnostics"],
        )
        assert command[0] == "check" or "infeasible: 1 error" in text
    with pytest.raises(irc.InputError) as caught:
        irc.compile(INFEASIBLE[name])
    assert caught.value.outcome.status == "infeasible"


def test_a_history_without_continuation_is_told_in_the_same_form(
    write: Callable[..., Path],
) -> None:
    task = baking("x", {"duration": 5}, {"duration": 5, "deadline": 12})
    plan = {"actions": [*PLAN["actions"], {"id": "a1", "start": 5, "end": 10}]}
    late = {"at": 2, "changes": [{"op": "set_duration", "action": "a0", "duration": 9}]}
    file, schedule, event = write(task), write(plan, "plan.json"), write([late], "event.json")
    code, step, text = ended("replan", file, "--schedule", schedule, "--at", 2, "--event", event)
    outcome = require(step, 1, "infeasible")
    assert (code, step["schedule"]["outcome"]) == (1, outcome)
    assert [d["code"] for d in outcome["diagnostics"]] == ["IRC710"]
    assert "error[IRC710]" in text
    code, simulation, _ = ended(
        "simulate", write({**task, "events": [late]}), "--schedule", schedule
    )
    assert require(simulation, 1, "infeasible")["diagnostics"][0]["code"] == "IRC710"
    run = run_irc(
        *("run", file, "--stdio", "--schedule", schedule),
        stdin=json.dumps({"do": "apply", "event": late, "replan": True}),
    )
    answer = json.loads(run.stdout.splitlines()[1])
    assert (answer["ok"], answer["step"]["outcome"]) == (True, outcome)


# --- unknown, refused, faulty, misused, missing, failed -----------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("command", ["solve", "simulate"])
def test_an_unknown_outcome_has_the_form_too(command: str, write: Callable[..., Path]) -> None:
    document = baking("x", {"duration": 4, "start": 3}, {"duration": 4, "deadline": 9})
    options = ("--target", "pddl21", "--engine", "kairos", "--time-limit", 0.3)
    code, shown, text = ended(command, write(document), *options)
    outcome = require(shown, 3, "unknown")
    assert code == 3
    assert {d["code"] for d in outcome["diagnostics"]} == {"IRC604"}
    assert "unknown" in text
    assert "note[IRC604]" in text


@pytest.mark.parametrize("command", ["solve", "simulate", "compile", "run"])
def test_a_refused_task_has_the_form_too(command: str, write: Callable[..., Path]) -> None:
    arguments = (command, write(REFUSED), "--target", "pddl21")
    if command == "run":
        result = run_irc(*arguments, "--stdio")
        assert (result.exit_code, "refused: 1 error" in result.stderr) == (1, True)
        return
    code, document, text = ended(*arguments)
    assert code == 1
    assert [d["code"] for d in require(document, 1, "refused")["diagnostics"]] == ["IRC501"]
    assert "refused: 1 error" in text
    with pytest.raises(irc.InputError) as caught:
        irc.solve(REFUSED, "pddl21")
    assert caught.value.outcome.status == "refused"


@pytest.mark.parametrize(
    "command",
    [
        *(("check",), ("solve",), ("simulate",), ("explain",), ("compile", "--target", "cpsat")),
        ("replan", "--schedule", "plan.json", "--at", "1"),
        ("validate", "plan.json"),
        ("targets",),
    ],
    ids=lambda command: command[0],
)
def test_a_faulty_input_has_the_form_too(
    command: tuple[str, ...], write: Callable[..., Path]
) -> None:
    file, plan = write(FAULTY), write(PLAN, "plan.json")
    name, *options = (str(plan) if text == "plan.json" else text for text in command)
    code, document, _ = ended(name, file, *options)
    assert code == 1
    assert [d["code"] for d in require(document, 1, "faulty")["diagnostics"]] == ["IRC102"]


def test_wrong_use_and_engines_that_are_missing_have_the_form_too(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(baking("x", {"duration": 5}, {"duration": 5}))
    code, document, text = ended("solve", file, "--target", "abacus")
    outcome = require(document, 2, "misused")
    assert (code, outcome["message"]) == (2, document["message"])
    assert f"error: {outcome['message']}" in text
    monkeypatch.delenv("IRC_OPTIC", raising=False)
    monkeypatch.setenv("PATH", "/nowhere")
    options = ("--target", "pddl21", "--engine", "optic", "--no-shortcut")
    code, document, text = ended("solve", file, *options)
    assert (code, require(document, 4, "missing")["message"]) == (4, document["message"])
    with pytest.raises(irc.EngineMissing) as caught:
        irc.solve(file, "pddl21", engine="optic", shortcut=False)
    assert caught.value.outcome == Outcome("missing", str(caught.value))


def test_a_refused_request_of_a_run_has_the_form_too(write: Callable[..., Path]) -> None:
    file = write(baking("x", {"duration": 5}))
    result = run_irc("run", file, "--stdio", stdin='{"do": "fly"}\n{"do": "advance", "to": -1}\n')
    for line in result.stdout.splitlines()[1:]:
        answer = json.loads(line)
        outcome = require(answer, 1, "faulty")
        assert outcome["diagnostics"] == answer["error"]["diagnostics"]


# --- the statuses -------------------------------------------------------------------------------


def test_every_status_has_the_exit_status_that_is_documented() -> None:
    assert {
        exit_codes.EXIT_DONE,
        exit_codes.EXIT_INPUT,
        exit_codes.EXIT_USE,
        exit_codes.EXIT_NO_ANSWER,
        exit_codes.EXIT_ENGINE,
        130,
    } == set(EXIT_STATUS.values())
    assert {str(status) for status in irc.Status} <= EXIT_STATUS.keys()


def test_every_exception_of_the_package_ends_as_a_status_says() -> None:
    waiting = [irc.IrcError]
    while waiting:
        kind = waiting.pop()
        waiting += kind.__subclasses__()
        assert kind.ends_as in EXIT_STATUS


def test_an_answer_has_an_outcome_and_its_document_is_as_before() -> None:
    schedule = irc.solve(baking("x", {"duration": 5}), options=SolveOptions(workers=1))
    assert (schedule.outcome.answered, schedule.outcome.exit) == (True, 0)
    assert "outcome" not in schedule.to_dict()
    assert str(schedule.outcome) == "optimal: this is the best schedule"
    assert irc.check(baking("x", {"duration": 5})).outcome.answered


def test_which_codes_prove_that_there_is_no_schedule() -> None:
    proofs = {code.id for code in Code if code.proves_infeasible}
    assert proofs == {*(f"IRC3{k:02}" for k in range(1, 11)), "IRC710"}
