"""PDDL2.1 text of state, choices, stock, calendars, groups and rewards, and the way back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from builders import Document, lettered, task_of
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.frontends.files import read_task
from irc.problem.decisions import AnswerError
from irc.targets import Program
from irc.validation import validate
from irc_pddl21.decoding.plan_reader import read_plans
from irc_pddl21.encoding.encode import encode
from irc_pddl21.encoding.grounded import Grounded
from irc_pddl21.encoding.pddl import NumericCondition, Operator
from paths import GOLDEN_TASKS

DOOR = {"id": "door", "values": ["open", "shut", "locked"], "initial": "open"}
SHUTS = {"at": "end", "var": "door", "value": "shut"}


def program_of(*actions: Document, **more: Any) -> Program:
    return compile_task(task_of(*lettered(*actions), **more), "pddl21")


def grounded(program: Program) -> Grounded:
    return encode(program.problem)


def operator(program: Program, name: str) -> Operator:
    return next(o for o in grounded(program).encoding.operators if o.name == name)


def operator_names(program: Program) -> set[str]:
    return {o.name for o in grounded(program).encoding.operators}


def plan(*steps: tuple[float, str, float | None]) -> str:
    lines = [
        f"{start}: ({name})" + ("" if lasts is None else f" [{lasts}]")
        for start, name, lasts in steps
    ]
    return "; Plan found with metric 1\n" + "\n".join(lines) + "\n"


def decoded(program: Program, *steps: tuple[float, str, float | None]) -> dict[str, Any]:
    """Valid entries by id and number: (start, end)."""
    schedule = program.decode(plan(*steps))
    assert validate(program.task, schedule).valid
    return {f"{e.id}{e.occurrence}": (e.start, e.end) for e in schedule.entries}


# --- state ----------------------------------------------------------------------------------------


def test_an_effect_takes_the_other_values_away_and_gives_its_own() -> None:
    reads = [{"at": "all", "var": "door", "value": value} for value in ("shut", "open")]
    program = program_of(
        {"effects": [SHUTS]}, {"conditions": reads[:1]}, {"conditions": reads[1:]}, state=[DOOR]
    )
    shut = operator(program, "a")
    assert shut.end_deletes == ["is_door_open"]
    assert "is_door_shut" in shut.end_adds
    assert "is_door_open" in grounded(program).encoding.initial


def test_a_value_that_nobody_asks_for_is_the_loss_of_the_others() -> None:
    program = program_of(
        {"effects": [{"at": "end", "var": "door", "value": "locked"}]},
        {"conditions": [{"at": "all", "var": "door", "value": "open"}]},
        state=[DOOR],
    )
    assert operator(program, "a").end_deletes == ["is_door_open"]
    assert not any("locked" in fact for fact in grounded(program).encoding.facts)


@pytest.mark.parametrize(
    ("at", "part"), [("start", "at_start"), ("all", "over_all"), ("end", "at_end")]
)
def test_conditions_stand_where_they_must_hold(at: str, part: str) -> None:
    lock = {"effects": [{"at": "start", "var": "door", "value": "locked"}]}
    read = {"conditions": [{"at": at, "var": "door", "value": "open"}]}
    program = program_of(lock, read, state=[DOOR])
    assert "is_door_open" in getattr(operator(program, "b"), part)


def test_an_instant_needs_all_of_its_conditions_just_before() -> None:
    read = {"duration": 0, "conditions": [{"at": "end", "var": "door", "value": "shut"}]}
    text = program_of({"effects": [SHUTS]}, read, state=[DOOR]).files["domain.pddl"]
    assert "(:action b\n    :parameters ()\n    :precondition (and (todo_b) (is_door_shut))" in text


def test_state_goals_are_goals_and_planner_names_say_what_they_mean() -> None:
    program = program_of(
        {"occurs": "optional", "effects": [SHUTS]},
        state=[DOOR],
        goals=[{"var": "door", "value": "shut"}],
    )
    assert grounded(program).encoding.goal == ["is_door_shut"]
    assert program.names["state"] == {"is_door_shut": "'door' is 'shut'"}


def test_an_action_that_contradicts_itself_is_refused_with_its_place() -> None:
    both = [{"at": "start", "var": "door", "value": value} for value in ("shut", "locked")]
    with pytest.raises(InputError, match="two values") as caught:
        program_of({}, {"effects": both}, state=[DOOR])
    assert caught.value.report.errors[0].pointer[:2] == ("actions", 1)


def test_a_match_lights_a_mend_that_starts_at_the_same_instant() -> None:
    program = program_of(
        {
            "duration": 5,
            "effects": [
                {"at": "start", "var": "lit", "value": True},
                {"at": "end", "var": "lit", "value": False},
            ],
        },
        {"duration": 4, "conditions": [{"at": w, "var": "lit"} for w in ("start", "all")]},
        state=[{"id": "lit"}],
    )
    steps = ((0.0, "a", 5.0), (0.001, "b", 4.0))
    assert decoded(program, *steps) == {"a1": (0, 5), "b1": (0, 4)}


# --- what may be absent --------------------------------------------------------------------------


def test_an_optional_action_is_no_goal_unless_it_is_wanted() -> None:
    actions: tuple[Document, ...] = ({"occurs": "optional"}, {"occurs": "optional"})
    assert grounded(program_of(*actions)).encoding.goal == []
    assert grounded(program_of(*actions, goals=["b"])).encoding.goal == ["done_b"]


def test_what_waits_for_an_absent_action_goes_on_at_once() -> None:
    edge = {"before": "a", "after": "b", "min_lag": 7}
    program = program_of({"occurs": "optional"}, {}, precedence=[edge])
    skip = operator(program, "skip_a")
    assert skip.at_start == skip.start_deletes == ["todo_a"]
    assert set(operator(program, "b").at_start) - {"todo_b"} <= set(skip.start_adds)
    assert decoded(program, (0.0, "skip_a", None), (0.001, "b", 2.0)) == {"b1": (0, 2)}


def test_a_group_is_declined_as_a_whole_or_done_as_a_whole() -> None:
    group = {"id": "order", "actions": ["a", "b"], "required": False}
    program = program_of({}, {}, {}, groups=[group])
    decline = operator(program, "decline_order")
    assert decline.at_start == decline.start_deletes == ["todo_a", "todo_b"]
    assert decline.start_adds == ["done_a", "done_b"]
    assert set(grounded(program).encoding.goal) == {"done_a", "done_b", "done_c"}


def test_a_required_group_cannot_be_declined() -> None:
    group = {"id": "order", "actions": ["a", "b"]}
    assert operator_names(program_of({}, {}, groups=[group])) == {"a", "b"}


def test_a_wanted_member_makes_its_group_mandatory() -> None:
    group = {"id": "order", "actions": ["a", "b"], "required": False}
    program = program_of({}, {}, groups=[group], goals=["a"])
    assert operator_names(program) == {"a", "b"}
    assert set(grounded(program).encoding.goal) == {"done_a", "done_b"}


def test_half_a_group_in_a_plan_is_not_used() -> None:
    group = {"id": "order", "actions": ["a", "b"], "required": False}
    program = program_of({}, {}, groups=[group])
    with pytest.raises(AnswerError):
        program.decode(plan((0.0, "a", 2.0), (0.0, "c", 2.0)))


# --- modes ---------------------------------------------------------------------------------------

PRESS = [{"id": "press"}, {"id": "hand"}]
JUICE = {
    "modes": [
        {"id": "machine", "duration": 2, "uses": [{"resource": "press"}]},
        {"id": "hand", "duration": 5, "uses": [{"resource": "hand"}]},
        {"id": "bottle", "duration": 0},
    ]
}
BUSY = [{"uses": [{"resource": r}]} for r in ("press", "hand")]


def test_each_mode_is_an_operator_with_its_own_duration_and_uses() -> None:
    program = program_of({**JUICE, "duration": None}, *BUSY, resources=PRESS)
    names = [n for n in operator_names(program) if n.startswith("a__")]
    assert {n: operator(program, n).duration for n in names} == {
        "a__machine__press_1": (2, 2),
        "a__hand__hand_1": (5, 5),
        "a__bottle": None,
    }


def test_the_mode_of_a_plan_is_the_mode_of_the_schedule() -> None:
    program = program_of({**JUICE, "duration": None}, *BUSY, resources=PRESS)
    steps = ((0.0, "a__hand__hand_1", 5.0), (0.0, "b", 2.0), (5.001, "c", 2.0))
    schedule = program.decode(plan(*steps))
    assert validate(program.task, schedule).valid
    (juice,) = [e for e in schedule.entries if e.id == "a"]
    assert (juice.mode, juice.start, juice.end, dict(juice.resources)) == (
        "hand",
        0,
        5,
        {"hand": 1},
    )


# --- repetition ----------------------------------------------------------------------------------


def test_least_occurrences_are_a_chain_and_only_they_are_goals() -> None:
    program = program_of({"occurs": {"min": 2, "max": 3}})
    assert operator_names(program) == {"a", "a_2", "a_3"}
    assert "done_a_2" in operator(program, "a_3").at_start
    assert grounded(program).encoding.goal == ["done_a", "done_a_2"]


def test_what_may_happen_without_end_waits_only_for_itself() -> None:
    program = program_of({"occurs": {"min": 0}})
    again = operator(program, "a")
    assert again.at_start == again.start_deletes == again.end_adds == ["idle_a"]
    assert again.needs == []


def test_many_occurrences_count_down() -> None:
    program = program_of({"occurs": {"min": 1, "max": 40}})
    again = operator(program, "a_again")
    assert again.needs == [NumericCondition("start", ">=", "left_for_a", 1)]
    assert grounded(program).encoding.counters == {"left_for_a": 39}
    assert operator(program, "a").end_adds == ["done_a", "idle_a"]


def test_occurrences_in_a_plan_are_numbered_by_start() -> None:
    program = program_of({"occurs": {"min": 0}})
    steps = ((2.001, "a", 2.0), (0.0, "a", 2.0), (9.0, "a", 2.0))
    assert decoded(program, *steps) == {"a1": (0, 2), "a2": (2, 4), "a3": (4, 6)}


def test_more_occurrences_than_there_may_be_are_not_used() -> None:
    program = program_of({"occurs": {"min": 1, "max": 2}})
    steps = ((0.0, "a", 2.0), (2.001, "a_2", 2.0), (4.002, "a_2", 2.0))
    with pytest.raises(AnswerError, match="more than 2 times"):
        program.decode(plan(*steps))


# --- stock ---------------------------------------------------------------------------------------


def test_taking_asks_for_enough_and_putting_for_room() -> None:
    flour = {"id": "flour", "kind": "reservoir", "initial": 2, "min": 1, "max": 4}
    program = program_of(
        {"consumes": [{"resource": "flour", "amount": 2}]},
        {"produces": [{"resource": "flour", "amount": 3}]},
        resources=[flour],
    )
    take, put = operator(program, "a"), operator(program, "b")
    assert take.needs == [NumericCondition("start", ">=", "level_of_flour", 3)]
    assert put.needs == [NumericCondition("end", "<=", "level_of_flour", 1)]
    assert ":fluents" in program.files["domain.pddl"]


def test_stock_that_is_always_enough_needs_no_counter() -> None:
    flour = {"id": "flour", "kind": "reservoir", "initial": 2}
    takes = {"consumes": [{"resource": "flour", "amount": 1}]}
    assert grounded(program_of(takes, takes, resources=[flour])).encoding.counters == {}
    gives = {"produces": [{"resource": "flour", "amount": 1}]}
    assert grounded(program_of(takes, takes, takes, gives, resources=[flour])).encoding.counters


# --- calendars -----------------------------------------------------------------------------------


def test_a_unit_that_is_away_cannot_be_held_and_may_be_held_until_it_goes() -> None:
    oven = {"id": "oven", "availability": [{"from": 4, "to": 6, "capacity": 0}]}
    bake = {"uses": [{"resource": "oven"}]}
    program = program_of(bake, bake, bake, resources=[oven])
    text = grounded(program)
    assert "here_oven_1" in operator(program, "a").over_all
    gone, back = sorted((t.time, t.value) for t in text.encoding.timed)
    assert gone == (2 * text.scale + text.slack, False)
    assert back == (3 * text.scale, True)
    lasts = float(text.scale)
    steps = ((0.0, "a", lasts), (lasts + 0.001, "b", lasts), (3 * lasts + 0.001, "c", lasts))
    assert decoded(program, *steps) == {"a1": (0, 2), "b1": (2, 4), "c1": (6, 8)}


def test_a_calendar_that_only_adds_leaves_the_base_units_alone() -> None:
    bench = {"id": "bench", "availability": [{"from": 2, "to": 8, "capacity": 2}]}
    cut = {"uses": [{"resource": "bench"}]}
    program = program_of(cut, cut, cut, resources=[bench])
    assert "here_bench_2" not in operator(program, "a__bench_1").over_all
    assert "here_bench_2" in operator(program, "a__bench_2").over_all
    assert "here_bench_2" not in grounded(program).encoding.initial


# --- objectives ----------------------------------------------------------------------------------


def test_the_metric_is_the_first_objective_and_the_manifest_names_the_others() -> None:
    program = program_of(
        {"occurs": "optional", "reward": 3},
        {"occurs": "optional"},
        groups=[{"id": "order", "actions": ["b"], "required": False, "reward": 4}],
        objective=["maximize_reward", "minimize_makespan"],
    )
    assert "(:metric maximize (sum_of_reward))" in program.files["problem.pddl"]
    assert [c.amount for name in "ab" for c in operator(program, name).changes] == [3, 4]
    assert program.names["objectives_beyond_the_metric"] == ["makespan"]


def test_costs_are_minimised_by_the_metric() -> None:
    program = program_of({"occurs": "optional", "cost": 3}, {}, objective=["minimize_cost"])
    assert "(:metric minimize (sum_of_cost))" in program.files["problem.pddl"]


def test_earliness_is_refused_and_a_due_date_without_it_is_not() -> None:
    with pytest.raises(InputError, match="minimize_earliness"):
        program_of({"due": 3}, objective=["minimize_earliness"])
    assert operator_names(program_of({"due": 3}, {})) == {"a", "b"}


# --- a second opinion ----------------------------------------------------------------------------

TASKS = GOLDEN_TASKS


@pytest.mark.slow
@pytest.mark.parametrize("name", ["state", "modes", "optional_actions", "calendars"])
def test_unified_planning_accepts_the_raw_plan_on_the_emitted_text(
    name: str, tmp_path: Path
) -> None:
    kairos = pytest.importorskip("kairos")
    pytest.importorskip("unified_planning")
    from unified_planning.engines.plan_validator import TimeTriggeredPlanValidator
    from unified_planning.environment import get_environment
    from unified_planning.io import PDDLReader
    from unified_planning.plans import ActionInstance, TimeTriggeredPlan

    get_environment().credits_stream = None
    program = compile_task(read_task(TASKS / f"{name}.json").task, "pddl21")
    for file, text in program.files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    domain = kairos.parse_domain(program.files["domain.pddl"])
    parsed = kairos.parse_problem(program.files["problem.pddl"], domain)
    raw = str(next(iter(kairos.Planner().plans(parsed, timeout=5.0, threads=1))))
    problem = PDDLReader().parse_problem(*(str(tmp_path / file) for file in program.files))
    steps = [
        (step.start, ActionInstance(problem.action(step.name)), step.duration)
        for step in read_plans(raw).plans[0].steps
    ]
    with TimeTriggeredPlanValidator() as validator:
        verdict = validator.validate(problem, TimeTriggeredPlan(steps, problem.environment))
    assert verdict, (verdict.reason, verdict.log_messages)
    assert validate(program.task, program.decode(raw)).valid
