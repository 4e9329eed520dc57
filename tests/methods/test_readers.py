"""Readers of what language models write: the states of an answer, its graph, task and plan."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from irc import solve
from irc.frontends.importers.plan_lines import plan_schedule
from irc.methods import (
    AnswerState,
    read_nl_ir,
    read_pddl_answer,
    read_plan,
    read_plan_answer,
    read_planner,
    read_schedule_spec,
)
from irc.methods.lenient_pddl import read_pddl_task

PLANNER = {
    "actions": [{"id": "step1", "duration": 5}, {"id": "step2", "duration": 7}],
    "dependencies": [{"before": "step1", "after": "step2"}],
    "final_answer_seconds": 12,
}


@pytest.mark.parametrize(
    ("text", "state"),
    [
        ("", AnswerState.EMPTY),
        (" \n\t", AnswerState.EMPTY),
        ('{"actions": [{"id": "step1", "dura', AnswerState.TRUNCATED),
        ('{"actions": [{"id": "step1",\n "label": "a\nb', AnswerState.TRUNCATED),
        ("I cannot do that", AnswerState.TRUNCATED),
        ('{"actions": [}', AnswerState.MALFORMED),
        ("```json\n{'actions': []}\n```", AnswerState.MALFORMED),
        ('{"actions": []}', AnswerState.INVALID),
        ('{"steps": []}', AnswerState.INVALID),
        (json.dumps(PLANNER), AnswerState.OK),
        (f"Here it is:\n```json\n{json.dumps(PLANNER)}\n```\nDone.", AnswerState.OK),
        (f"Here it is: {json.dumps(PLANNER)} as you wanted", AnswerState.OK),
    ],
)
def test_the_states_of_an_answer_are_kept_apart(text: str, state: AnswerState) -> None:
    answer = read_planner(text)
    assert answer.state is state
    assert answer.report.ok == (state is AnswerState.OK)


def test_a_planner_gives_a_task_and_the_makespan_that_it_states() -> None:
    answer = read_planner(json.dumps({**PLANNER, "final_answer_seconds": 13}))
    assert answer.stated_makespan == 13
    assert answer.task is not None
    assert solve(answer.task).makespan == 12


def test_every_fault_of_an_answer_is_named_in_one_round() -> None:
    wrong = {
        "actions": [{"id": "step1", "duration": "long"}, {"duration": 3}],
        "dependencies": [{"before": "step1", "after": "step9"}, {"from": "step1"}],
    }
    messages = [d.message for d in read_planner(json.dumps(wrong)).report]
    assert len(messages) == 4
    assert "'step1'" in messages[0]
    assert "'step9'" in messages[3]


def test_a_spec_holds_stations_robots_lags_and_fixed_starts() -> None:
    spec = {
        "mode": "schedule",
        "actions": [
            {"id": "cut_a", "action": "cut", "item": "a", "duration": 3, "station": "board"},
            {"id": "cut_b", "action": "cut", "item": "b", "duration": 3, "station": "board"},
            {"id": "stack_a", "action": "stack", "item": "a", "duration": 1, "station": "board"},
            {"id": "wait", "action": "task", "item": "w", "duration": 1, "earliest_start": 20},
        ],
        "dependencies": [
            {"predecessor": "cut_a", "successor": "stack_a", "min_lag": 2},
            ["cut_b", "stack_a"],
        ],
    }
    answer = read_schedule_spec(json.dumps(spec))
    assert answer.state is AnswerState.OK
    assert answer.task is not None
    assert [r.id for r in answer.task.resources] == ["board"]
    assert answer.task.actions[2].uses == ()
    schedule = solve(answer.task)
    assert schedule.makespan == 21
    by_id = {entry.id: entry for entry in schedule.entries}
    assert by_id["stack_a"].start >= 6
    wider = read_schedule_spec(json.dumps(spec), {"board": 2}, ["r1"])
    assert wider.task is not None
    assert {r.id: r.capacity for r in wider.task.resources} == {"board": 2, "r1": 1}


def test_a_spec_with_goals_alone_is_marked() -> None:
    goals = {"mode": "optimize", "candidate_goals": [{"id": "g", "item": "a", "state": "cut"}]}
    answer = read_schedule_spec(json.dumps(goals))
    assert answer.state is AnswerState.OK
    assert answer.actions_from_gold
    assert answer.task is None
    assert read_schedule_spec('{"mode": "optimize"}').state is AnswerState.INVALID


def test_unknown_fields_of_a_spec_are_one_warning_each() -> None:
    actions = [{"id": f"s{k}", "duration": 1, "colour": "red", "mood": 1} for k in range(50)]
    report = read_schedule_spec(json.dumps({"actions": actions})).report
    assert [d.message for d in report] == [
        "field 'colour' is not read (50 actions have it)",
        "field 'mood' is not read (50 actions have it)",
    ]
    assert report.ok


def test_dependencies_of_an_ir_mean_precedence() -> None:
    written = {k: v for k, v in PLANNER.items() if k != "final_answer_seconds"}
    answer = read_nl_ir(json.dumps(written))
    assert answer.task is not None
    assert [(p.before, p.after) for p in answer.task.precedence] == [("step1", "step2")]


def test_plan_lines_are_read_with_joined_names_and_without_waits() -> None:
    text = """Plan:
0.000: (cut robot1 apple)  [3.000]
 3.001 : (grill_big_patty robot2) [10]
13.002: (wait_grill_patty) [1.0]
no line
"""
    plan = read_plan(text)
    assert [(line.action, line.arguments) for line in plan] == [
        ("cut", ("robot1", "apple")),
        ("grill", ("robot2", "big_patty")),
    ]
    assert plan[1].end == Fraction("13.001")
    assert len(read_plan(text, with_waits=True)) == 3
    entry = plan_schedule(plan).entries[1]
    assert (entry.id, entry.start, entry.end) == ("grill_big_patty", Fraction("3.001"), plan[1].end)
    assert entry.resources == {"grill": 1, "robot2": 1}


def test_an_answer_without_a_line_of_a_plan_is_malformed() -> None:
    assert read_plan_answer("").state is AnswerState.EMPTY
    answer = read_plan_answer("first I cut the apple")
    assert answer.state is AnswerState.MALFORMED
    assert "0.000: (cut" in (answer.report.diagnostics[0].hint or "")


DOMAIN = """(define (domain d)
  (:durative-action bake :parameters (?s - step) :duration (= ?duration 45) ; minutes
    :condition (and (at start (pending ?s)) (over all (mixed)) (at start (not (burnt))))
    :condition (at start (hot))
    :effect (and (at start (not (pending ?s))) (at end (baked))))
  (:durative-action mix (:duration 5) (:effect (at end (mixed)))))"""
PROBLEM = "(define (problem p) (:init (pending s1) (= (cost) 1)) (:goal (and (baked) (not (x)))))"


def test_pddl_is_read_however_it_is_put_together() -> None:
    task = read_pddl_task(DOMAIN, PROBLEM)
    bake, mix = task.schemas
    assert bake.conditions == (("pending", "?s"), ("mixed",), ("hot",))
    assert bake.adds == (("baked",),)
    assert (bake.duration, mix.duration) == (45, 5)
    assert mix.adds == (("mixed",),)
    assert task.initial == {("pending", "s1")}
    assert task.goals == (("baked",),)


def test_pddl_with_too_few_or_too_many_parentheses_is_read_as_far_as_it_goes() -> None:
    assert len(read_pddl_task(DOMAIN[:-9], PROBLEM).schemas) == 2
    assert len(read_pddl_task(DOMAIN.replace("(baked))))", "(baked)))))"), PROBLEM).schemas) == 2


def test_the_texts_of_a_pddl_answer_are_those_of_its_first_response() -> None:
    response = {"domain_pddl": "D", "problem_pddl": "P", "step_actions": ["a", "b"]}
    answer = read_pddl_answer(json.dumps({"responses": [response, {"domain_pddl": "E"}]}))
    assert (answer.domain, answer.problem, answer.step_actions) == ("D", "P", ("a", "b"))
    assert read_pddl_answer('{"domain": "D"}').state is AnswerState.INVALID
    assert read_pddl_answer('{"domain": "D').state is AnswerState.TRUNCATED


def test_a_stated_makespan_in_quotes_is_a_number() -> None:
    assert read_planner(json.dumps({**PLANNER, "final_answer_seconds": "12"})).stated_makespan == 12
    wrong = read_planner(json.dumps({**PLANNER, "final_answer_seconds": "soon"}))
    assert wrong.stated_makespan is None
