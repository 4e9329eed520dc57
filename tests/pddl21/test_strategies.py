"""Strategies over planners: hard deadlines, steps, choices of what is worth most; honest proofs."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import combinations
from typing import Any

import pytest

import irc
from builders import Document, after_passes, lettered, task_of
from irc.driver.compile import lower_for
from irc.driver.solve import solve_task
from irc.model import Task
from irc.passes.restrict import decide_presence, drop_ample_stock, restrict
from irc.passes.serial_sgs import quick_makespan
from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision
from irc.retiming.retime import retime
from irc.schedule import Status
from irc.targets import Budget, Program, SolveOptions, get_backend
from irc.validation import validate
from irc_pddl21.decoding.rounding import rounded
from irc_pddl21.planners.kairos import KairosPlanner
from irc_pddl21.search.list_schedules import searched_schedule, short_list_schedule
from irc_pddl21.search.neighbourhood import makespan_of, near, neighbourhoods
from irc_pddl21.search.planner_session import PlannerSession
from irc_pddl21.search.reachability import is_out_of_reach
from irc_pddl21.search.selection import SelectionSpace, is_refuted, optional_items
from oracles.generators import contended_task
from oracles.state_generators import match_cellar, reward_task, state_task


def problem_of(*actions: Document, **more: Any) -> Problem:
    return after_passes(task_of(*lettered(*actions), **more))


def needs_kairos() -> None:
    pytest.importorskip("kairos")


# --- fewer choices -------------------------------------------------------------------------------


def test_restricting_keeps_what_is_chosen_and_drops_the_rest() -> None:
    problem = problem_of(
        {},
        {"occurs": "optional"},
        {"occurs": "optional"},
        precedence=[["a", "b"], ["a", "c"]],
    )
    less = restrict(problem, present={1}, absent={2})
    assert [a.id for a in less.activities] == ["a", "b"]
    assert less.is_plain
    assert [(arc.before, arc.after) for arc in less.arcs] == [(0, 1)]


def test_what_belongs_to_a_group_that_must_be_there_is_mandatory() -> None:
    group = {"id": "g", "actions": ["a", "b"], "required": False}
    problem = decide_presence(
        problem_of({}, {}, {"occurs": "optional"}, groups=[group], goals=["b"])
    )
    assert [a.details.optional for a in problem.activities] == [False, False, True]


def test_a_group_with_a_member_that_cannot_be_is_gone() -> None:
    group = {"id": "g", "actions": ["a", "b"], "required": False, "deadline": 100}
    never: Document = {"occurs": {"min": 0, "max": 0}}
    problem = decide_presence(problem_of(never, {"occurs": "optional"}, {}))
    assert [a.id for a in problem.activities] == ["b", "c"]
    assert decide_presence(problem_of({}, {}, groups=[group])).groups


def test_only_stock_that_can_run_out_or_over_is_kept() -> None:
    takes: Document = {"consumes": [{"resource": "flour", "amount": 2}]}
    flour = {"id": "flour", "kind": "reservoir", "initial": 4}
    assert not drop_ample_stock(problem_of(takes, takes, resources=[flour])).reservoirs
    assert drop_ample_stock(problem_of(takes, takes, takes, resources=[flour])).reservoirs


# --- bounds on choices ---------------------------------------------------------------------------


def best_by_trying(selections: SelectionSpace) -> int:
    """The greatest value of a choice that no bound refutes."""
    size = len(selections.items)
    return max(
        selections.value(chosen)
        for n in range(size + 1)
        for chosen in map(frozenset, combinations(range(size), n))
        if not is_refuted(selections.restricted(chosen), thoroughly=False)
        and selections.upper_bound(chosen, frozenset()) is not None
    )


def small_reward_problem(seed: int) -> Problem:
    rng = random.Random(f"selection {seed}")
    groups = [
        {"id": f"g{k}", "actions": ["abcdefg"[k]], "required": False, "reward": rng.randint(1, 9)}
        for k in range(7)
    ]
    actions = [
        {
            "duration": rng.randint(1, 6),
            "uses": [{"resource": rng.choice(("oven", "grill"))}],
            "consumes": [{"resource": "bun", "amount": rng.randint(1, 2)}],
        }
        for _ in range(7)
    ]
    resources = [
        {"id": "oven"},
        {"id": "grill"},
        {"id": "bun", "kind": "reservoir", "initial": rng.randint(3, 8)},
    ]
    return problem_of(
        *actions,
        groups=groups,
        resources=resources,
        deadline=rng.randint(4, 12),
        objective=["maximize_reward"],
    )


@pytest.mark.parametrize("seed", range(12))
def test_no_choice_is_worth_more_than_the_upper_bound_says(seed: int) -> None:
    problem = small_reward_problem(seed)
    selections = SelectionSpace(problem, optional_items(problem, ("reward",)).items)
    everything = frozenset(range(len(selections.items)))
    upper = selections.upper_bound(frozenset(), everything)
    assert upper is not None
    assert best_by_trying(selections) <= upper <= selections.value(everything)
    hurried = SelectionSpace(problem, optional_items(problem, ("reward",)).items, lambda: True)
    quick = hurried.upper_bound(frozenset(), everything)
    assert quick is not None
    assert upper <= quick <= selections.value(everything)


def test_without_time_the_first_run_is_for_who_has_no_answer_yet() -> None:
    task = task_of(*lettered({"occurs": "optional", "reward": 1}), objective=["maximize_reward"])
    backend = get_backend("pddl21")
    program = Program(backend, task, lower_for(task, backend))
    session = PlannerSession(KairosPlanner(), program, SolveOptions(), Budget(0))
    assert not session.is_over
    session.keep(irc.Schedule(()))
    assert session.is_over


def test_an_objective_counts_more_than_all_behind_it() -> None:
    problem = problem_of(
        {"occurs": "optional", "reward": 1, "cost": 50},
        {"occurs": "optional", "reward": 0, "cost": 3},
    )
    items, worths, _ = optional_items(problem, ("reward", "cost"))
    values = {item.members: item.value for item in items}
    assert values[0,] > 0 > values[1,]
    assert worths.first_bound(values[0,]) == 1


def test_each_further_occurrence_with_a_reward_is_an_item() -> None:
    repeated = {"occurs": {"min": 1, "max": 3}, "reward": 4}
    found = optional_items(problem_of(repeated), ("reward",))
    assert [item.value for item in found.items] == [4, 4]
    assert found.all_there


def test_as_many_occurrences_are_items_as_the_deadline_has_time_for() -> None:
    endless = {"occurs": {"min": 0}, "reward": 1, "duration": 3}
    assert not optional_items(problem_of(endless), ("reward",)).all_there
    found = optional_items(problem_of(endless, deadline=10), ("reward",))
    assert found.all_there
    assert len(found.items) == 3


def test_a_selection_has_the_occurrences_that_were_chosen() -> None:
    problem = problem_of({"occurs": {"max": 3}, "reward": 1}, {})
    space = SelectionSpace(problem, optional_items(problem, ("reward",)).items)
    counts = []
    for chosen in ((), (1,), (0, 2)):
        restricted = space.restricted(frozenset(chosen))
        assert restricted is not None
        counts.append([a.details.repeats for a in restricted.activities])
    assert counts == [[None], [None, None], [(2, 2), None]]
    assert space.canonical(frozenset([0, 2])) == {0, 1}


def test_a_selection_whose_lags_contradict_each_other_is_refuted() -> None:
    problem = problem_of(
        {}, {"occurs": "optional", "reward": 1}, precedence=[["a", "b"], ["b", "a"]]
    )
    space = SelectionSpace(problem, optional_items(problem, ("reward",)).items)
    assert is_refuted(space.restricted(frozenset([0])), thoroughly=False)
    assert not is_refuted(space.restricted(frozenset()), thoroughly=False)


def test_a_goal_that_nothing_present_can_give_is_refuted() -> None:
    effects = [{"at": "end", "var": "lit", "value": True}]
    problem = problem_of(
        {"occurs": "optional", "effects": effects},
        {},
        state=[{"id": "lit"}],
        goals=[{"var": "lit"}],
    )
    assert not is_out_of_reach(problem)
    assert is_out_of_reach(restrict(problem, set(), {0}))


@pytest.mark.parametrize(
    ("goal", "extra", "expected"),
    [
        ({"at_least": 5}, {"occurs": "optional"}, False),
        ({"at_least": 6}, {"occurs": "optional"}, True),
        ({"at_most": 1}, {"occurs": "optional"}, False),
        ({"at_most": 0}, {"occurs": "optional"}, True),
        ({"at_most": 4}, {}, True),
        ({"at_least": 9}, {"occurs": {"min": 1, "max": 3}}, False),
    ],
)
def test_a_number_ends_within_what_all_may_add(
    goal: Document, extra: Document, expected: bool
) -> None:
    adds = {"effects": [{"var": "level", "add": 4, "at": "end"}], **extra}
    takes = {"effects": [{"var": "level", "add": -1, "at": "start"}]}
    level = {"id": "level", "kind": "number", "initial": 2}
    problem = problem_of(adds, takes, state=[level], goals=[{"var": "level", **goal}])
    assert is_out_of_reach(problem) is expected


# --- neighbourhoods ------------------------------------------------------------------------------


def test_what_is_not_free_keeps_its_order_and_its_resource() -> None:
    uses = {"uses": [{"one_of": ["r1", "r2"]}, {"resource": "oven"}]}
    resources = [{"id": "r1", "capacity": 1}, {"id": "r2"}, {"id": "oven"}]
    problem = problem_of(uses, uses, {**uses, "uses": [{"resource": "r1"}]}, resources=resources)
    shared = [r.id for r in problem.contention.pools]

    def taken(i: int, *names: str) -> tuple[int, ...]:
        return tuple(
            next(r for r in claim.alternatives if shared[r] in names)
            for claim in problem.activities[i].open_demands
        )

    def robots(less: Problem) -> list[str]:
        (claim,) = [
            c for c in less.activities[0].open_demands if shared[c.alternatives[0]] != "oven"
        ]
        return [shared[r] for r in claim.alternatives]

    known = {
        0: (Decision(2, 4), taken(0, "r1", "oven")),
        1: (Decision(0, 2), taken(1, "r2", "oven")),
        2: (Decision(0, 2), taken(2, "r1")),
    }
    kept = near(problem, known, frozenset())
    assert {(a.before, a.after) for a in kept.arcs} == {(1, 0), (2, 0)}
    assert robots(kept) == ["r1"]
    freed = near(problem, known, frozenset([0]))
    assert not freed.arcs
    assert robots(freed) == ["r1", "r2"]


def test_neighbourhoods_grow_and_come_to_an_end() -> None:
    known = {i: (Decision(i, i + 1), ()) for i in range(12)}
    sizes = [len(free) for free in neighbourhoods(known, random.Random(0))]
    assert sizes == sorted(sizes)
    assert (sizes[0], sizes[-1]) == (6, 10)


# --- whole answers -------------------------------------------------------------------------------


def solved(task: Task, seconds: float = 6.0) -> irc.Schedule:
    needs_kairos()
    schedule = solve_task(task, SolveOptions("pddl21", "kairos", seconds, shortcut=False)).schedule
    assert validate(task, schedule).valid
    return schedule


@pytest.mark.parametrize("seed", range(4))
def test_contended_tasks_reach_the_optimum_and_say_so(seed: int) -> None:
    task = contended_task(random.Random(f"strategy {seed}"), 8)
    best = solve_task(task, SolveOptions(time_limit=20)).schedule
    mine = solved(task)
    assert (mine.status, mine.makespan) == (Status.OPTIMAL, best.makespan)


def test_rewards_under_a_deadline_and_stock() -> None:
    task = Task.model_validate(
        {
            "resources": [{"id": "grill"}, {"id": "bun", "kind": "reservoir", "initial": 2}],
            "actions": [
                {
                    "id": name,
                    "duration": duration,
                    "uses": [{"resource": "grill"}],
                    "consumes": [{"resource": "bun", "amount": 1}],
                }
                for name, duration in (("a", 6), ("b", 3), ("c", 4), ("d", 2))
            ],
            "groups": [
                {"id": f"g{name}", "actions": [name], "required": False, "reward": reward}
                for name, reward in (("a", 9), ("b", 5), ("c", 5), ("d", 4))
            ],
            "deadline": 7,
            "objective": ["maximize_reward", "minimize_makespan"],
        }
    )
    schedule = solved(task)
    # b and c would fit (7) for 10, a with anything would not.
    assert schedule.status is Status.OPTIMAL
    assert [(o.name, o.value, o.bound) for o in schedule.objective] == [
        ("reward", 10, 10),
        ("makespan", 7, 7),
    ]


def test_the_empty_choice_is_an_answer() -> None:
    task = Task.model_validate(
        {
            "actions": [{"id": "a", "duration": 9}],
            "groups": [{"id": "g", "actions": ["a"], "required": False, "reward": 5}],
            "deadline": 8,
            "objective": ["maximize_reward"],
        }
    )
    schedule = solved(task)
    assert (schedule.status, schedule.entries) == (Status.OPTIMAL, ())


@pytest.mark.slow
def test_the_cheapest_way_is_found_and_proven() -> None:
    moved = {"effects": [{"at": "end", "var": "moved", "value": True}], "occurs": "optional"}
    task = Task.model_validate(
        {
            "state": [{"id": "moved"}],
            "actions": [
                {"id": "taxi", "duration": 1, "cost": 9, **moved},
                {"id": "walk", "duration": 5, "cost": 1, **moved},
            ],
            "goals": [{"var": "moved"}],
            "objective": ["minimize_cost", "minimize_makespan"],
        }
    )
    schedule = solved(task)
    assert [e.id for e in schedule.entries] == ["walk"]
    assert schedule.status is Status.OPTIMAL


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 5, 6])
def test_random_reward_tasks_are_never_called_optimal_wrongly(seed: int) -> None:
    task = reward_task(seed)
    best = solve_task(task, SolveOptions(time_limit=30)).schedule
    mine = solved(task)
    assert mine.objective[0].value >= 0.9 * float(best.objective[0].value)
    if mine.status is Status.OPTIMAL:
        assert [o.value for o in mine.objective] == [o.value for o in best.objective]


def test_a_reward_that_was_not_proven_is_feasible_and_says_how_much_more_there_could_be(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A planner that finds nothing for the best choice leaves its value open."""
    needs_kairos()
    from irc_pddl21.search.planner_session import PlannerSession

    task = Task.model_validate(
        {
            "resources": [{"id": "grill"}],
            "actions": [
                {"id": name, "duration": 3, "uses": [{"resource": "grill"}]} for name in "ab"
            ],
            "groups": [
                {"id": f"g{name}", "actions": [name], "required": False, "reward": 5}
                for name in "ab"
            ],
            "deadline": 6,
            "objective": ["maximize_reward"],
        }
    )
    ask = PlannerSession.ask

    def hides_two(self: PlannerSession, problem: Problem, *args: Any, **more: Any) -> Any:
        return None if len(problem.activities) == 2 else ask(self, problem, *args, **more)

    monkeypatch.setattr(PlannerSession, "ask", hides_two)
    schedule = solved(task, seconds=3.0)
    assert schedule.status is Status.FEASIBLE
    assert [(o.value, o.bound) for o in schedule.objective] == [(5, 10)]


@pytest.mark.slow
def test_a_planner_gets_one_time_limit_over_all_of_its_runs() -> None:
    needs_kairos()
    task = contended_task(random.Random("strategy 17"), 19)
    backend = get_backend("pddl21")
    problem = lower_for(task, backend).with_bound(1, "too low to be met")
    program = irc.targets.Program(backend, task, problem)
    outcome = backend.engines()["kairos"].solve(program, SolveOptions(), Budget(2))
    assert outcome.seconds < 3.5
    assert outcome.status is Status.FEASIBLE


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 2, 4, 6])
def test_match_cellars_are_as_short_as_on_cp_sat(seed: int) -> None:
    """Some want a mend to end before its match and to follow another mend at once."""
    needs_kairos()
    task = match_cellar(seed)
    best = solve_task(task, SolveOptions(time_limit=20)).schedule
    mine = solve_task(task, SolveOptions("pddl21", "kairos", 6)).schedule
    if best.status is Status.INFEASIBLE:
        assert mine.status is Status.UNKNOWN
        return
    assert validate(task, mine).valid
    assert mine.makespan == best.makespan


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(16))
def test_random_state_tasks_are_valid_and_never_called_optimal_wrongly(seed: int) -> None:
    needs_kairos()
    task = state_task(seed)
    try:
        mine = solve_task(task, SolveOptions("pddl21", "kairos", 1.5)).schedule
    except irc.InputError:
        return  # Refused with a reason; that CP-SAT takes it is tested elsewhere.
    best = solve_task(task, SolveOptions(time_limit=20)).schedule
    if not mine.answered:
        assert mine.status in (Status.UNKNOWN, Status.INFEASIBLE)
        assert mine.status is Status.UNKNOWN or best.status is Status.INFEASIBLE
        return
    assert validate(task, mine).valid
    mine_values, best_values = ([o.value for o in s.objective] for s in (mine, best))
    assert (mine_values == best_values) or mine.status is Status.FEASIBLE


# --- list schedules and shortened actions ---------------------------------------------------------


def test_a_hint_is_no_longer_than_the_list_schedule_and_keeps_order_and_capacity() -> None:
    task = contended_task(random.Random("strategy 7"), 18)
    problem = lower_for(task, get_backend("pddl21"))
    known = short_list_schedule(problem, problem.bounds.makespan.value, Budget(1), random.Random(0))
    quick = quick_makespan(problem)
    assert known is not None
    assert quick is not None
    assert problem.bounds.makespan.value <= makespan_of(known) <= quick
    followed = near(problem, known, frozenset())
    assert retime(problem, [known[i][0] for i in range(len(problem.activities))])
    assert len(followed.arcs) > len(problem.arcs)


def test_a_pool_whose_users_all_keep_their_order_is_not_asked_for() -> None:
    use = {"duration": 2, "uses": [{"resource": "crew", "amount": 2}]}
    other = {"duration": 2, "uses": [{"resource": "van"}]}
    away = [{"from": 9, "to": 11, "capacity": 0}]
    resources = [{"id": "crew", "capacity": 3}, {"id": "van", "availability": away}]
    problem = problem_of(use, use, other, other, resources=resources)
    known = short_list_schedule(problem, 0, Budget(1), random.Random(0))
    assert known is not None
    assert makespan_of(known) == 4

    def asked(free: frozenset[int]) -> list[bool]:
        return [bool(a.open_demands) for a in near(problem, known, free).activities]

    assert asked(frozenset()) == [False, False, True, True]
    assert asked(frozenset([0])) == [True, True, True, True]


def test_local_search_gives_a_schedule_to_follow() -> None:
    machines = [{"id": "m1"}, {"id": "m2"}]
    steps = [
        {"duration": d, "uses": [{"resource": m}]}
        for d, m in ((3, "m1"), (2, "m2"), (2, "m2"), (4, "m1"), (4, "m1"), (1, "m2"))
    ]
    jobs = [["a", "b"], ["c", "d"], ["e", "f"]]
    problem = problem_of(*steps, resources=machines, precedence=jobs)
    known = searched_schedule(problem, 11, Budget(30), 0)
    assert known is not None
    assert makespan_of(known) == 11
    assert retime(problem, [known[i][0] for i in range(len(problem.activities))])
    optional = problem_of({"occurs": "optional"}, {})
    assert searched_schedule(optional, 0, Budget(1), 0) is None


def test_there_is_no_hint_where_a_list_schedule_would_overlook_something() -> None:
    optional = problem_of({"occurs": "optional"}, {})
    assert short_list_schedule(optional, 0, Budget(1), random.Random(0)) is None


LAMP = {"state": [{"id": "lit"}]}
LIGHT = {
    "effects": [
        {"at": "start", "var": "lit", "value": True},
        {"at": "end", "var": "lit", "value": False},
    ]
}


def test_a_plan_with_shortened_actions_is_read_as_ticks_and_ranks() -> None:
    read_by_it = {"conditions": [{"at": at, "var": "lit"} for at in ("start", "all")]}
    problem = problem_of({**LIGHT, "duration": 3}, {**read_by_it, "duration": 2}, **LAMP)
    times = [Decision(0, Fraction(299, 100)), Decision(Fraction(99, 100), Fraction(298, 100))]
    light, mend = rounded(problem, times)
    assert [(d.start, d.end) for d in (light, mend)] == [(0, 3), (1, 3)]
    assert mend.rank < light.rank  # Its end comes before the light goes out.


def test_an_order_that_no_ranks_keep_is_not_used() -> None:
    """One action cannot begin after another and end before it at the same two instants."""
    both = {"conditions": [{"at": "start", "var": "lit"}, {"at": "all", "var": "lit"}]}
    problem = problem_of({**LIGHT, "duration": 3}, {**both, "duration": 3}, **LAMP)
    times = [Decision(0, Fraction(299, 100)), Decision(Fraction(1, 1000), Fraction(298, 100))]
    with pytest.raises(AnswerError, match="no ranks"):
        rounded(problem, times)


def test_a_missed_choice_of_equal_value_leaves_the_makespan_unproven(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It might have been shorter than the one that was found."""
    needs_kairos()
    from irc_pddl21.search.planner_session import PlannerSession

    task = Task.model_validate(
        {
            "resources": [{"id": "bun", "kind": "reservoir", "initial": 1}],
            "actions": [
                {"id": name, "duration": lasts, "consumes": [{"resource": "bun", "amount": 1}]}
                for name, lasts in (("a", 2), ("b", 5))
            ],
            "groups": [
                {"id": f"g{name}", "actions": [name], "required": False, "reward": 5}
                for name in "ab"
            ],
            "deadline": 6,
            "objective": ["maximize_reward", "minimize_makespan"],
        }
    )
    ask = PlannerSession.ask

    def hides_a(self: PlannerSession, problem: Problem, *args: Any, **more: Any) -> Any:
        present = [a.id for a in problem.activities]
        return None if present == ["a"] else ask(self, problem, *args, **more)

    with monkeypatch.context() as patch:
        patch.setattr(PlannerSession, "ask", hides_a)
        longer = solved(task, seconds=3.0)
    assert [o.value for o in longer.objective] == [5, 5]
    assert longer.status is Status.FEASIBLE
    shorter = solved(task)
    assert ([o.value for o in shorter.objective], shorter.status) == ([5, 2], Status.OPTIMAL)


def test_a_plan_of_instants_alone_is_read() -> None:
    task = Task.model_validate(
        {
            "state": [{"id": "lit"}],
            "actions": [
                {"id": "look", "duration": 0, "conditions": [{"at": "start", "var": "lit"}]},
                {"id": "light", "duration": 0, "effects": [{"at": "end", "var": "lit"}]},
            ],
            "goals": [{"var": "lit"}],
        }
    )
    assert solved(task).makespan == 0
