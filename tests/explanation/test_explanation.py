"""Explanations: minimal conflicts of infeasible tasks, critical chains of feasible ones."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.checks import run_checks
from irc.explanation import explain_task
from irc.explanation.chain import critical_chain
from irc.explanation.contention import resource_conflict
from irc.explanation.wording import in_words
from irc.model import Task
from irc.passes.mandatory import mandatory_part
from irc.problem import Activity, Problem
from irc.problem.statements import (
    KINDS,
    Kind,
    Statement,
    all_statements,
    pointer_of,
    problem_of,
)
from irc.schedule import Entry, Schedule, Status
from irc.targets import Budget, get_backend
from irc.targets.refuter import Assumptions
from oracles.brute_force import optimal_makespan
from oracles.conflicts import by_solving, faults_of, only, statements_of
from oracles.generators import big_capacity_task, random_task
from oracles.infeasible_tasks import CASES, SOLVER, TIME, Case, a, p, r, task
from paths import EXAMPLES
from runs import run_irc

each_case = pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])


def texts(explanation: irc.Explanation) -> set[str]:
    return {told.text for told in explanation.conflict}


# --- conflicts ----------------------------------------------------------------------------------


def test_the_corpus_is_as_large_as_it_should_be() -> None:
    assert len({case.name for case in CASES}) == len(CASES)
    assert len(TIME) >= 15
    assert len(SOLVER) >= 25


@each_case
def test_the_conflict_is_the_one_written_down_by_hand(case: Case) -> None:
    explanation = irc.explain(case.document)
    assert texts(explanation) == case.expected
    assert (explanation.by, explanation.minimal, explanation.feasible) == (case.by, True, False)
    assert len(explanation.conflict) == len(case.expected)


@pytest.mark.slow
@each_case
def test_removing_any_statement_of_a_conflict_resolves_it(case: Case) -> None:
    checked = Task.model_validate(case.document)
    assert faults_of(checked, irc.explain(checked)) == []


def _infeasible(seed: int) -> Task | None:
    """A random infeasible task whose faults are not of shape."""
    draw = big_capacity_task if seed % 7 == 0 else random_task
    drawn = draw(random.Random(seed), tighten=1.0)
    if any(d.code.id == "IRC106" for d in irc.check(drawn).errors):
        return None
    return drawn if optimal_makespan(drawn) is None else None


@pytest.mark.slow
def test_random_infeasible_tasks_get_minimal_conflicts() -> None:
    found = [t for seed in range(70) if (t := _infeasible(seed)) is not None]
    by = set()
    for drawn in found:
        explanation = irc.explain(drawn)
        by.add(explanation.by)
        assert explanation.minimal
        assert faults_of(drawn, explanation, lambda t: optimal_makespan(t) is not None) == []
    assert len(found) >= 20
    assert by >= {"time", "solver"}


def test_the_check_by_removal_knows_wrong_conflicts() -> None:
    checked = Task.model_validate(SOLVER[0].document)
    explanation = irc.explain(checked)
    fewer = replace(explanation, conflict=explanation.conflict[1:])
    assert faults_of(checked, fewer) == ["these can hold together"]
    extra = Task.model_validate(SOLVER[1].document)
    spare = irc.explain(extra)
    more = replace(spare.conflict[-1], pointer=("actions", 0, "duration"))
    assert faults_of(extra, replace(spare, conflict=(*spare.conflict, more))) == [
        "not needed: ('actions', 0, 'duration')"
    ]


@pytest.mark.slow
def test_the_same_task_gets_the_same_explanation_however_it_is_ordered() -> None:
    for case in SOLVER[::5]:
        document = case.document
        shuffled = {**document, "actions": document["actions"][::-1]}
        shuffled["precedence"] = document["precedence"][::-1]
        one, other = irc.explain(document), irc.explain(shuffled)
        assert [t.text for t in one.conflict] == [t.text for t in other.conflict]


def test_a_conflict_of_time_is_told_in_the_order_of_time() -> None:
    case = next(c for c in TIME if "boil yam" in str(c.document))
    assert [told.text for told in irc.explain(case.document).conflict] == [
        "'boil yam' takes 12 s",
        "'boil yam' precedes 'mash yam'",
        "'mash yam' takes 8 s",
        "'mash yam' precedes 'stack'",
        "'stack' takes 5 s",
        "everything ends by 24 s",
    ]
    assert irc.explain(case.document).reason == "one after another they need 1 s more than there is"


@pytest.mark.slow
def test_a_long_chain_needs_no_solver_and_little_time() -> None:
    actions = [a(f"step {k}", 2) for k in range(400)]
    arcs = [p(f"step {k}", f"step {k + 1}") for k in range(399)]
    explanation = irc.explain(task(*actions, *arcs, deadline=799))
    assert len(explanation.conflict) == 800
    assert explanation.minimal
    assert "ortools" not in _modules_after_explaining(actions[:3], arcs[:2], 5)


def _modules_after_explaining(actions: Any, arcs: Any, deadline: int) -> set[str]:
    document = {"actions": actions, "precedence": arcs, "deadline": deadline}
    code = f"import sys, irc; irc.explain({document!r}); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in done.stdout.split()}


def test_a_conflict_is_found_among_elements_that_are_not_explained() -> None:
    document = task(
        *(a("a", 5), a("b", 3), p("a", "b")),
        deadline=7,
        state=[{"id": "lit"}],
    )
    document["actions"][0]["effects"] = [{"at": "end", "var": "lit", "value": True}]
    assert len(irc.explain(document).conflict) == 4
    solved = irc.explain({**document, "deadline": 8})
    assert (solved.feasible, solved.bound, solved.chain, solved.slack) == (True, 8, (), {})
    document["actions"][1]["conditions"] = [{"at": "start", "var": "lit", "value": False}]
    stuck = irc.explain({**document, "deadline": 8})
    assert (stuck.feasible, stuck.minimal) == (False, True)
    assert [s.kind for s in stuck.conflict] == ["effect", "condition", "precedence"]


def test_other_faults_are_told_as_ever() -> None:
    with pytest.raises(irc.InputError) as found:
        irc.explain(task(a("a", 5, "grlil"), r("grill"), p("a", "a"), deadline=3))
    assert {d.code.id for d in found.value.report.errors} >= {"IRC201", "IRC204"}


def test_without_time_nothing_is_called_minimal() -> None:
    case = next(c for c in SOLVER if c.name == "no order of three windows")
    document = Task.model_validate(case.document)
    problem = run_checks(document).problem
    refuter = get_backend("cpsat").refuter()
    assert refuter is not None
    assert resource_conflict(problem, refuter, Budget(0)) is None
    undecided = resource_conflict(problem, _Undecided(refuter), Budget())
    assert undecided is not None
    assert not undecided.minimal


class _Undecided:
    """Decides nothing but the whole: as a solver whose time is over."""

    def __init__(self, refuter: Any) -> None:
        self.refuter = refuter
        self.whole: int | None = None

    def core(self, assumptions: Assumptions, budget: Budget) -> frozenset[Statement] | None:
        return None

    def decide(self, problem: Problem, horizon: int, budget: Budget) -> Status:
        self.whole = self.whole or len(problem.activities)
        if len(problem.activities) < self.whole:
            return Status.UNKNOWN
        status = self.refuter.decide(problem, horizon, budget)
        return Status.UNKNOWN if status is Status.FEASIBLE else status


class _Misleading:
    """A solver whose cores are wrong, as google/or-tools#5141 says they may be."""

    def __init__(self, refuter: Any) -> None:
        self.refuter = refuter
        self.asked = 0

    def core(self, assumptions: Assumptions, budget: Budget) -> frozenset[Statement] | None:
        self.asked += 1
        core = sorted(self.refuter.core(assumptions, budget))
        return frozenset(core[1:])

    def decide(self, problem: Problem, horizon: int, budget: Budget) -> Status:
        return self.refuter.decide(problem, horizon, budget)


def test_a_solvers_core_is_not_believed() -> None:
    case = next(c for c in SOLVER if c.name == "no order of three windows")
    problem = run_checks(Task.model_validate(case.document)).problem
    misleading = _Misleading(get_backend("cpsat").refuter())
    conflict = resource_conflict(problem, misleading, Budget())
    assert misleading.asked == 1
    assert conflict is not None
    assert {in_words(problem, s) for s in conflict.statements} == case.expected


def test_the_solvers_core_leaves_out_what_is_far_from_the_conflict() -> None:
    far = [a(f"far {k}", 3, "shed") for k in range(6)]
    case = next(c for c in SOLVER if c.name == "no order of three windows")
    parts = [*case.document["actions"], *case.document["resources"], r("shed"), *far]
    problem = run_checks(Task.model_validate(task(*parts))).problem
    listening = _Listening(get_backend("cpsat").refuter())
    conflict = resource_conflict(problem, listening, Budget())
    assert conflict is not None
    assert {in_words(problem, s) for s in conflict.statements} == case.expected
    assert listening.core_found is not None
    names = {problem.activities[s.of].id for s in listening.core_found if s.kind is Kind.USE}
    assert names == {"cat", "dog", "cow"}


class _Listening(_Misleading):
    core_found: frozenset[Statement] | None = None

    def core(self, assumptions: Assumptions, budget: Budget) -> frozenset[Statement] | None:
        self.core_found = self.refuter.core(assumptions, budget)
        return self.core_found


# --- statements ---------------------------------------------------------------------------------

EVERYTHING = task(
    *(r("crew", 3), {**r("r1"), "no_idle": True}),
    {**r("r2"), "setups": {"initial": "x", "times": [{"from": "x", "to": "*", "time": 1}]}},
    a("a", 4, ("crew", 2), ["r2", "r1"], release=2, deadline=20, latest_start=15, earliest_end=5),
    a("b", {"min": 2, "max": 6}, start=9),
    p("a", "b", "ss", min_lag=1, max_lag=8),
    a("c", 1),
    groups=[{"id": "g", "actions": ["b", "c"], "deadline": 28, "required": True}],
    deadline=30,
)


def everything(document: dict[str, Any] | Task = EVERYTHING) -> Problem:
    """What an explanation is about: the part of a task that every schedule has."""
    return mandatory_part(run_checks(Task.model_validate(document)).problem)[0]


def test_every_kind_has_words_and_a_place_that_exists() -> None:
    problem = everything()
    statements = all_statements(problem)
    assert {s.kind for s in statements} == set(Kind) == set(KINDS)
    places = {pointer_of(problem, s) for s in statements}
    assert places == statements_of(Task.model_validate(EVERYTHING))
    assert len({in_words(problem, s) for s in statements}) == len(statements)


def test_the_problem_of_all_statements_is_the_whole_problem() -> None:
    problem = everything()
    whole = problem_of(problem, all_statements(problem), 1000)
    assert whole == problem


def limits_of(activity: Activity) -> tuple[Any, ...]:
    a = activity
    return a.id, a.release, a.deadline, a.start, a.latest_start, a.earliest_end


def test_a_problem_without_a_statement_is_that_of_the_document_without_it() -> None:
    checked = Task.model_validate(EVERYTHING)
    problem = everything(checked)
    statements = all_statements(problem)
    for left_out in statements:
        kept = [s for s in statements if s != left_out]
        places = [pointer_of(problem, s) for s in kept]
        part = problem_of(problem, kept, 100_000)
        document = everything(only(checked, places))
        scale = document.tick / part.tick
        assert scale == 1
        assert [limits_of(x) for x in part.activities] == [
            limits_of(x) for x in document.activities
        ]
        assert [(x.duration_min, x.duration_max) for x in part.activities] == [
            (x.duration_min, x.duration_max) for x in document.activities
        ]
        assert len(part.arcs) == len(document.arcs)
        assert part.deadline == document.deadline


# --- chains -------------------------------------------------------------------------------------


def _feasible(seed: int) -> Task | None:
    drawn = random_task(random.Random(seed), tighten=0.0)
    return drawn if optimal_makespan(drawn) is not None else None


@pytest.mark.slow
def test_the_lengths_of_a_chain_add_up_to_the_makespan() -> None:
    handed_over = 0
    for seed in range(60):
        drawn = _feasible(seed)
        if drawn is None:
            continue
        explanation = irc.explain(drawn)
        assert explanation.schedule is not None
        assert explanation.chain is not None
        chain, makespan = explanation.chain, explanation.schedule.makespan
        assert makespan == optimal_makespan(drawn)
        assert sum(step.end - step.start for step in chain) == makespan
        assert [step.start for step in chain[:1]] == [0]
        assert all(one.end == other.start for one, other in pairwise(chain))
        handed_over += any(step.statement.kind == "hand_over" for step in chain)
        _hold_with_equality(drawn, explanation)
    assert handed_over >= 10


def _hold_with_equality(drawn: Task, explanation: irc.Explanation) -> None:
    """Each link against the document: it could not be shorter."""
    assert explanation.schedule is not None
    entries = {entry.id: entry for entry in explanation.schedule.entries}
    for step in explanation.chain or ():
        kind, pointer, length = step.statement.kind, step.statement.pointer, step.end - step.start
        if kind == "precedence":
            arc = drawn.precedence[int(pointer[1])]
            first, second = arc.type.split("-")
            before, after = entries[arc.before], entries[arc.after]
            gap = (after.start if second == "start" else after.end) - (
                before.start if first == "start" else before.end
            )
            assert (gap == arc.min_lag == length) or (gap == arc.max_lag == -length)
        elif kind == "duration":
            entry = entries[drawn.actions[int(pointer[1])].id]
            assert abs(length) == entry.end - entry.start
        elif kind in ("release", "start"):
            assert length == getattr(drawn.actions[int(pointer[1])], kind)
        elif kind in ("hand_over", "order"):
            assert length == 0
            resource = drawn.resources[int(pointer[1])].id
            ended = {e.id for e in entries.values() if resource in e.resources}
            assert any(entries[name].end == step.start for name in ended)
            assert any(entries[name].start == step.start for name in ended)
        else:
            assert kind == "time"


def test_a_chain_of_precedences_is_called_a_proof() -> None:
    explanation = irc.explain(EXAMPLES / "pancake_breakfast.json")
    assert [step.statement.kind for step in explanation.chain or ()].count("duration") >= 2
    assert explanation.proof is not None
    assert explanation.proof.startswith("no schedule is shorter: the chain needs no resource")


def test_a_hand_over_names_the_station_and_both_actions() -> None:
    document = task(
        r("grill"), a("patty", 6, "grill"), a("halloumi", 4, "grill"), p("patty", "halloumi", "ss")
    )
    explanation = irc.explain(document)
    assert [step.statement.text for step in explanation.chain or ()] == [
        "'patty' can start at once",
        "'patty' takes 6 s",
        "'grill': 'patty' → 'halloumi'",
        "'halloumi' takes 4 s",
    ]
    assert explanation.proof is not None
    assert explanation.proof.startswith("no other order is better: ")
    assert explanation.slack == {"patty": 0, "halloumi": 0}


def test_a_chain_prefers_precedence_to_a_hand_over_at_the_same_time() -> None:
    document = task(r("grill"), a("a", 6, "grill"), a("b", 4, "grill"), p("a", "b"))
    kinds = [step.statement.kind for step in irc.explain(document).chain or ()]
    assert kinds == ["time", "duration", "precedence", "duration"]


def test_a_schedule_that_idles_has_no_chain() -> None:
    problem = run_checks(Task.model_validate(task(a("a", 5)))).problem
    assert critical_chain(problem, Schedule((Entry("a", 3, 8),))) is None
    assert critical_chain(problem, Schedule((Entry("a", 0, 5),))) is not None


def test_an_empty_task_has_an_empty_chain() -> None:
    explanation = irc.explain({"actions": []})
    assert (explanation.chain, explanation.feasible) == ((), True)


def test_an_answer_that_is_not_proven_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    import irc.explanation.explain as road

    solve = road.solve_task

    def unproven(*arguments: Any, **named: Any) -> Any:
        answer = solve(*arguments, **named)
        return replace(
            answer,
            schedule=replace(answer.schedule, status=Status.FEASIBLE),
            lowered=answer.problem.with_bound(6, "the critical path"),
        )

    monkeypatch.setattr(road, "solve_task", unproven)
    document = task(r("grill"), a("a", 4, "grill"), a("b", 3, "grill"))
    explanation = explain_task(Task.model_validate(document))
    assert explanation.status is Status.FEASIBLE
    assert explanation.proof == (
        "another order may be better: at least 6 s are needed (the critical path)"
    )


# --- the command --------------------------------------------------------------------------------


def run(*arguments: str, given: str | None = None) -> Any:
    return run_irc("explain", *arguments, stdin=given)


def test_the_command_shows_the_lines_that_conflict(tmp_path: Path) -> None:
    (file := tmp_path / "late.json").write_text(
        '{"actions": [\n  {"id": "a", "duration": 5},\n  {"id": "b", "duration": 4}\n],\n'
        '"precedence": [["a", "b"]],\n"deadline": 8}\n'
    )
    result = run(str(file))
    assert result.exit_code == 1
    assert (
        result.stdout
        == f"""\
unnamed task: no schedule exists
these 4 statements cannot hold together; without any one of them the others can:

 --> {file}
2 |   {{"id": "a", "duration": 5}},
  |                           ^ 'a' takes 5 s
3 |   {{"id": "b", "duration": 4}}
  |                           ^ 'b' takes 4 s
5 | "precedence": [["a", "b"]],
  |                ^ 'a' precedes 'b'
6 | "deadline": 8}}
  |             ^ everything ends by 8 s

because one after another they need 1 s more than there is
"""
    )


def test_the_command_prints_json_with_places() -> None:
    document = json.dumps(SOLVER[0].document)
    result = run("-", "--format", "json", given=document)
    shown = json.loads(result.stdout)
    assert (result.exit_code, shown["irc_explanation"], shown["feasible"]) == (1, "1", False)
    assert (shown["status"], shown["minimal"], shown["by"]) == ("infeasible", True, "solver")
    assert {told["text"] for told in shown["conflict"]} == SOLVER[0].expected
    deadline = next(told for told in shown["conflict"] if told["kind"] == "task_deadline")
    assert (deadline["pointer"], deadline["line"]) == ("/deadline", 1)
    assert document[deadline["column"] - 1 :].startswith("10}")


def test_the_command_explains_a_feasible_task_with_status_0() -> None:
    result = run(str(EXAMPLES / "burger_kitchen.json"))
    assert result.exit_code == 0
    assert "'fryer': 'fry chips' → 'fry onion rings'" in result.stdout
    shown = json.loads(run(str(EXAMPLES / "burger_kitchen.json"), "--format", "json").stdout)
    assert sum(step["length"] for step in shown["chain"]) == shown["makespan"] == 15
    assert shown["slack"]["mix sauce"] == 9


def test_the_command_ends_with_status_3_where_time_is_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    unknown = irc.Explanation(Status.UNKNOWN, "busy", "s")
    monkeypatch.setattr("irc.explanation.explain_task", lambda *_, **__: unknown)
    result = run("-", given=json.dumps(SOLVER[0].document))
    assert result.exit_code == 3
    assert "--time-limit" in result.stdout


def test_a_faulty_file_gets_its_diagnostics_and_status_1() -> None:
    result = run("-", given='{"actions": [{"id": "a", "duration": -1}]}')
    assert result.exit_code == 1
    assert "IRC105" in result.stderr
    assert result.stdout == ""


def test_solve_points_to_the_explanation(tmp_path: Path) -> None:
    (file := tmp_path / "busy day.json").write_text(json.dumps(SOLVER[0].document))
    result = run_irc("solve", file)
    assert result.exit_code == 1
    assert f"`irc explain '{file}'`" in result.stderr


def test_names_cannot_move_the_cursor() -> None:
    document = task(a("\x1b[2J", 5), deadline=3, name="\x1b[31m")
    result = run("-", given=json.dumps(document))
    assert "\x1b" not in result.stdout


def test_conflicts_without_a_text_are_told_with_pointers() -> None:
    explanation = irc.explain(SOLVER[0].document)
    assert explanation.conflict[0].line is None
    assert str(explanation).startswith("task: infeasible, these statements cannot hold together\n")


def test_solving_and_removal_agree_about_the_whole() -> None:
    assert not by_solving(Task.model_validate(SOLVER[0].document))
    assert by_solving(only(Task.model_validate(SOLVER[0].document), []))
