"""The verdict: objective values, what a schedule states about itself, how it reads, bad input."""

from __future__ import annotations

import ast
from fractions import Fraction
from pathlib import Path
from time import process_time
from typing import Any

import pytest

import irc.validation
from irc.model import Task
from irc.schedule import Entry, ObjectiveValue, Schedule
from irc.validation import SHOWN_PER_RULE, InexactTimeError, UncheckedTaskError, validate

CUT = {"id": "cut", "duration": 3}


def stated(task: Task, *objective: ObjectiveValue, entry: Entry | None = None) -> list[str]:
    schedule = Schedule((entry or Entry("cut", 0, 3),), objective=objective)
    return [violation.message for violation in validate(task, schedule).violations]


# Objectives


def test_an_empty_schedule_of_nothing_is_valid_and_worth_nothing() -> None:
    verdict = validate(Task(actions=[]), Schedule(()))
    assert verdict.valid
    assert verdict.makespan == 0
    assert dict(verdict.objective) == {"makespan": 0, "tardiness": 0, "reward": 0, "cost": 0}


def test_tardiness_is_weighted_and_early_work_earns_nothing() -> None:
    task = Task(
        actions=[
            {"id": "a", "duration": 4, "due": 1, "weight": 5},
            {"id": "b", "duration": 4, "due": 9, "weight": 100},
            {"id": "c", "duration": 4, "due": 2},
        ]
    )
    entries = tuple(Entry(name, 0, 4) for name in "abc")
    assert validate(task, Schedule(entries)).objective["tardiness"] == 3 * 5 + 2 * 1


def test_a_group_is_late_by_its_last_end_and_only_if_it_is_there() -> None:
    task = Task(
        actions=[{"id": name, "duration": 2} for name in "ab"],
        groups=[
            {
                "id": "g",
                "actions": ["a", "b"],
                "required": False,
                "due": 1,
                "weight": 2,
                "reward": 7,
            }
        ],
    )
    there = validate(task, Schedule((Entry("a", 0, 2), Entry("b", 2, 4))))
    assert (there.objective["tardiness"], there.objective["reward"]) == (6, 7)
    absent = validate(task, Schedule(()))
    assert (absent.objective["tardiness"], absent.objective["reward"]) == (0, 0)


def test_reward_and_cost_count_every_occurrence() -> None:
    task = Task(actions=[{**CUT, "occurs": {"max": 3}, "reward": 4, "cost": 3}])
    entries = (Entry("cut", 0, 3), Entry("cut", 3, 6, occurrence=2))
    verdict = validate(task, Schedule(entries))
    assert (verdict.objective["reward"], verdict.objective["cost"]) == (8, 6)


def test_a_group_given_twice_is_rewarded_once() -> None:
    group = {"id": "g", "actions": ["cut"], "reward": 5}
    verdict = validate(Task(actions=[CUT], groups=[group, group]), Schedule((Entry("cut", 0, 3),)))
    assert verdict.objective["reward"] == 5


def test_a_stated_value_must_be_the_true_one() -> None:
    task = Task(actions=[CUT])
    assert stated(task, ObjectiveValue("makespan", 3), ObjectiveValue("tardiness", 0)) == []
    assert stated(task, ObjectiveValue("makespan", 2), ObjectiveValue("reward", 1)) == [
        "the makespan is 3, not 2 as stated",
        "the reward is 0, not 1 as stated",
    ]


def test_a_stated_bound_must_not_contradict_the_value() -> None:
    task = Task(actions=[{**CUT, "reward": 5}])
    assert stated(task, ObjectiveValue("makespan", 3, 3), ObjectiveValue("reward", 5, 8)) == []
    assert stated(task, ObjectiveValue("makespan", 3, 4), ObjectiveValue("reward", 5, 4)) == [
        "the stated lower bound on the makespan is above the value reached: 4 against 3",
        "the stated upper bound on the reward is below the value reached: 4 against 5",
    ]


def test_changes_are_taken_as_stated_and_unknown_objectives_refused() -> None:
    task = Task(actions=[CUT])
    assert stated(task, ObjectiveValue("changes", 17)) == []
    assert stated(task, ObjectiveValue("elegance", 1)) == [
        "there is no objective 'elegance'; "
        "the objectives are makespan, tardiness, reward, cost, changes"
    ]


# How it reads


def test_a_verdict_reads_well() -> None:
    task = Task(actions=[{**CUT, "cost": 3}], time_unit="min")
    assert str(validate(task, Schedule((Entry("cut", 0, 3),)))) == "valid: makespan 3 min, cost 3"
    assert str(validate(task, Schedule((Entry("cut", 1, 3),)))) == (
        "not valid, 1 violation:\n  rule 2, duration: 'cut' lasts 2 min (1 to 3) instead of 3 min"
    )


def test_a_verdict_is_told_in_json() -> None:
    task = Task(actions=[CUT])
    entry = Entry("cut", Fraction(1, 3), Fraction(7, 2))
    assert validate(task, Schedule((entry,))).to_dict() == {
        "irc_verdict": "1",
        "valid": False,
        "undecided": False,
        "makespan": 3.5,
        "objective": {"makespan": 3.5, "tardiness": 0, "reward": 0, "cost": 0},
        "violations": [
            {
                "rule": "duration",
                "number": 2,
                "message": "'cut' lasts 19/6 s (1/3 to 3.5) instead of 3 s",
                "actions": ["cut"],
                "times": ["1/3", 3.5],
            }
        ],
        "omitted": {},
    }


def test_violations_of_all_rules_are_told_in_the_order_of_the_rules() -> None:
    task = Task(
        actions=[
            {**CUT, "uses": [{"resource": "board"}]},
            {"id": "stack", "duration": 1, "consumes": [{"resource": "bread"}]},
            {"id": "eat", "duration": 1, "conditions": [{"at": "start", "var": "ready"}]},
        ],
        precedence=[("cut", "stack")],
        resources=[{"id": "board"}, {"id": "bread", "kind": "reservoir"}],
        state=[{"id": "ready"}],
        goals=[{"var": "ready"}],
    )
    entries = (Entry("cut", 0, 4), Entry("stack", 0, 1), Entry("eat", 0, 1), Entry("nap", 0, 1))
    schedule = Schedule(entries, objective=(ObjectiveValue("makespan", 1),))
    numbers = [violation.number for violation in validate(task, schedule).violations]
    assert numbers == [1, 2, 3, 4, 5, 6, 7, None]


def test_violations_of_one_rule_are_capped_and_the_rest_counted() -> None:
    count = SHOWN_PER_RULE + 30
    task = Task(actions=[{"id": f"a{i}", "duration": 1} for i in range(count)], deadline=1)
    verdict = validate(task, Schedule(tuple(Entry(f"a{i}", 1, 2) for i in range(count))))
    assert len(verdict.violations) == SHOWN_PER_RULE
    assert dict(verdict.omitted) == {"deadline": 30}
    assert str(verdict).startswith(f"not valid, {count} violations:")
    assert str(verdict).endswith("… and 30 more of rule deadline")


def test_a_long_list_of_users_is_cut_in_the_message_and_whole_in_the_actions() -> None:
    uses = [{"resource": "grill"}]
    task = Task(
        actions=[{"id": f"a{i}", "duration": 1, "uses": uses} for i in range(9)],
        resources=[{"id": "grill"}],
    )
    entries = tuple(Entry(f"a{i}", 0, 1, {"grill": 1}) for i in range(9))
    (violation,) = validate(task, Schedule(entries)).violations
    assert violation.message.endswith("(used by 'a0', 'a1', 'a2', 'a3', 'a4' and 4 more)")
    assert violation.actions == tuple(f"a{i}" for i in range(9))


def test_a_name_cannot_break_a_line_of_the_report() -> None:
    task = Task(actions=[{"id": "cut\n  rule 0: valid", "duration": 1}])
    assert len(str(validate(task, Schedule(()))).splitlines()) == 2


# Bad input


@pytest.mark.parametrize(
    ("fields", "name"),
    [
        ({"precedence": [("cut", "nobody")]}, "nobody"),
        ({"groups": [{"id": "g", "actions": ["nobody"]}]}, "nobody"),
        ({"goals": ["nobody"]}, "nobody"),
        ({"goals": [{"var": "nothing"}]}, "nothing"),
        ({"actions": [{**CUT, "uses": [{"resource": "nothing"}]}]}, "nothing"),
        ({"actions": [{**CUT, "uses": [{"one_of": ["nothing"]}]}]}, "nothing"),
        (
            {
                "actions": [
                    {
                        "id": "cut",
                        "modes": [{"id": "m", "duration": 1, "uses": [{"resource": "x"}]}],
                    }
                ]
            },
            "'x'",
        ),
        ({"actions": [{**CUT, "consumes": [{"resource": "nothing"}]}]}, "nothing"),
        ({"actions": [{**CUT, "conditions": [{"at": "start", "var": "nothing"}]}]}, "nothing"),
        ({"actions": [{**CUT, "effects": [{"at": "start", "var": "nothing"}]}]}, "nothing"),
        ({"actions": [{"id": "cut"}]}, "neither a duration nor modes"),
        ({"actions": [CUT, {**CUT, "duration": 4}]}, "defined twice"),
        ({"actions": [{**CUT, "release": "2030-01-01"}]}, "origin"),
        ({"actions": [{**CUT, "occurs": {"min": 0}, "start": 3}]}, "fixed start"),
    ],
)
def test_a_task_that_was_not_checked_is_a_clear_error(fields: dict[str, Any], name: str) -> None:
    task = Task(**{"actions": [CUT], **fields})
    with pytest.raises(UncheckedTaskError, match=name):
        validate(task, Schedule((Entry("cut", 0, 3),)))


def test_resources_of_the_wrong_kind_are_an_unchecked_task() -> None:
    resources = [{"id": "flour", "kind": "reservoir"}, {"id": "grill"}]
    for part in (
        {"uses": [{"resource": "flour"}]},
        {"produces": [{"resource": "grill"}]},
    ):
        task = Task(actions=[{**CUT, **part}], resources=resources)
        with pytest.raises(UncheckedTaskError):
            validate(task, Schedule((Entry("cut", 0, 3),)))


def test_overlapping_windows_are_an_unchecked_task() -> None:
    windows = [{"from": 0, "to": 3, "capacity": 1}, {"from": 2, "to": 4, "capacity": 1}]
    task = Task(
        actions=[{**CUT, "uses": [{"resource": "grill"}]}],
        resources=[{"id": "grill", "availability": windows}],
    )
    with pytest.raises(UncheckedTaskError, match="overlap"):
        validate(task, Schedule((Entry("cut", 0, 3, {"grill": 1}),)))


def test_precedence_of_a_repeated_action_is_an_unchecked_task() -> None:
    task = Task(
        actions=[{**CUT, "occurs": {"max": 2}}, {"id": "b", "duration": 1}],
        precedence=[("cut", "b")],
    )
    with pytest.raises(UncheckedTaskError, match="more than once"):
        validate(task, Schedule(()))


def test_a_binary_float_is_refused() -> None:
    entry = Entry("cut", 0.1, 3.1)  # type: ignore[arg-type]
    with pytest.raises(InexactTimeError, match=r"0\.1"):
        validate(Task(actions=[CUT]), Schedule((entry,)))


# What it stands on


@pytest.mark.slow
def test_the_validator_imports_nothing_it_should_be_independent_of() -> None:
    allowed = {
        "irc.diagnostics",
        "irc.display",
        "irc.errors",
        "irc.model",
        "irc.schedule",
        "irc.model.times",
        "irc.validation",
    }
    for path in Path(irc.validation.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                names = [node.module or ""]
            ours = [name for name in names if name.split(".")[0] == "irc"]
            assert all(".".join(name.split(".")[:2]) in allowed for name in ours), path.name


def chain(count: int) -> tuple[Task, Schedule]:
    actions = [
        {
            "id": f"a{i}",
            "duration": 2,
            "uses": [{"resource": "grill"}],
            "consumes": [{"resource": "flour"}],
            "conditions": [{"at": "start", "var": "hot", "value": bool(i)}],
            "effects": [{"at": "end", "var": "hot"}],
        }
        for i in range(count)
    ]
    task = Task(
        actions=actions,
        precedence=[(f"a{i}", f"a{i + k}") for k in (1, 2, 3) for i in range(count - k)],
        resources=[{"id": "grill"}, {"id": "flour", "kind": "reservoir", "initial": count}],
        state=[{"id": "hot"}],
    )
    entries = tuple(Entry(f"a{i}", 2 * i, 2 * i + 2, {"grill": 1}) for i in range(count))
    return task, Schedule(entries)


@pytest.mark.slow
def test_time_grows_about_linearly_with_the_size() -> None:
    def seconds(count: int) -> float:
        task, schedule = chain(count)
        start = process_time()
        assert validate(task, schedule).valid
        return process_time() - start

    seconds(100)
    # A quadratic step would take 64 times as long for 8 times the size.
    assert seconds(4000) < 40 * max(seconds(500), 0.01)
