"""PDDL2.1 text: what becomes of each element, and that planners can read and cannot misread it."""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from builders import EITHER, Document, kitchen_task, power
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.model import Task
from irc.problem.decisions import AnswerError
from irc.targets import Program
from irc.validation import validate
from irc_pddl21.encoding.encode import encode
from irc_pddl21.encoding.names import RESERVED, NameTable
from irc_pddl21.encoding.resources import MAX_VARIANTS
from irc_pddl21.encoding.time_scale import EPSILON
from oracles.brute_force import Optimum, optimal_schedule
from oracles.generators import big_capacity_task, contended_task, random_task


def program_of(*actions: Document, **more: Any) -> Program:
    return compile_task(kitchen_task(*actions, **more), "pddl21")


def random_programs(count: int) -> Iterator[tuple[Task, Program]]:
    """Programs of all features of the target; what the checks refuse is left out."""
    for seed in range(count):
        rng = random.Random(f"pddl {seed}")
        kinds = (random_task, big_capacity_task, lambda rng: contended_task(rng, 7))
        task = kinds[seed % 3](rng)
        try:
            yield task, compile_task(task, "pddl21")
        except InputError:
            continue


# --- a reader of its own ------------------------------------------------------------------------


def expressions(text: str) -> list[Any]:
    """Nested lists of the words of a PDDL text, in which there must be no comment."""
    assert ";" not in text
    stack: list[list[Any]] = [[]]
    for word in re.findall(r"[()]|[^\s()]+", text):
        if word == "(":
            stack.append([])
        elif word == ")":
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(word)
    (whole,) = stack
    (only,) = whole
    result: list[Any] = only
    return result


class Step(NamedTuple):
    """One operator: its duration, its conditions and its effects as (when, literal)."""

    name: str
    durative: bool
    duration: Any
    conditions: list[tuple[str, Any]]
    effects: list[tuple[str, Any]]

    def needs(self, when: str) -> list[str]:
        return [c[0] for w, c in self.conditions if w == when]

    def adds(self, when: str) -> list[str]:
        return [e[0] for w, e in self.effects if w == when and len(e) == 1]

    def deletes(self, when: str) -> list[str]:
        return [e[1][0] for w, e in self.effects if w == when and e[0] == "not"]


def timed(literals: list[Any], durative: bool) -> list[tuple[str, Any]]:
    assert literals[0] == "and"
    if not durative:
        return [("now", literal) for literal in literals[1:]]
    return [(f"{w} {at}", literal) for w, at, literal in literals[1:]]


def operators(domain: list[Any]) -> dict[str, Step]:
    found = {}
    for part in domain:
        if part[0] in (":durative-action", ":action"):
            durative = part[0] == ":durative-action"
            fields = dict(zip(part[2::2], part[3::2], strict=True))
            keys = (":condition", ":effect") if durative else (":precondition", ":effect")
            assert fields.pop(":parameters") == []
            conditions, effects = (timed(fields[key], durative) for key in keys)
            assert part[1] not in found
            found[part[1]] = Step(part[1], durative, fields.get(":duration"), conditions, effects)
    return found


class Text(NamedTuple):
    """Both files of a program, taken apart."""

    domain: list[Any]
    problem: list[Any]
    steps: dict[str, Step]

    def section(self, name: str) -> list[Any]:
        return next((p[1:] for p in self.domain + self.problem if p[0] == name), [])


def read(program: Program) -> Text:
    domain, problem = (expressions(program.files[n]) for n in ("domain.pddl", "problem.pddl"))
    return Text(domain, problem, operators(domain))


# --- what every text keeps ----------------------------------------------------------------------


@pytest.mark.slow
def test_sections_stand_in_the_order_of_the_grammar() -> None:
    for _, program in random_programs(40):
        text = read(program)
        domain = [part[0] for part in text.domain[1:]]
        order = ["domain", ":requirements", ":predicates", ":functions"]
        head = [name for name in domain if name in order]
        assert head == [name for name in order if name in head]
        assert domain[: len(head)] == head
        assert set(domain[len(head) :]) <= {":durative-action", ":action"}
        assert [part[0] for part in text.problem[1:]] == [
            *("problem", ":domain", ":init", ":goal", ":metric")
        ]
        assert text.section(":metric") == ["minimize", ["total-time"]]
        assert text.section("domain") == text.section(":domain") == ["irc_task"]


@pytest.mark.slow
def test_requirements_are_exactly_those_that_are_used() -> None:
    seen = Counter[str]()
    for _, program in random_programs(60):
        domain, problem = program.files["domain.pddl"], program.files["problem.pddl"]
        used = {
            ":durative-actions": "(:durative-action " in domain,
            ":duration-inequalities": ">= ?duration" in domain,
            ":fluents": "(increase " in domain,
            ":timed-initial-literals": re.search(r"\(at \d", problem) is not None,
        }
        told = read(program).section(":requirements")
        assert told == [name for name, is_used in used.items() if is_used] or told == [":strips"]
        assert (told == [":strips"]) == (not any(used.values()))
        seen.update(told)
    assert len(seen) >= 4


@pytest.mark.slow
def test_conditions_and_goals_are_positive() -> None:
    for _, program in random_programs(40):
        text = read(program)
        for step in text.steps.values():
            for _, condition in step.conditions:
                assert len(condition) == 1 or condition[0] == ">="
        (goal,) = text.section(":goal")
        assert goal[0] == "and"
        assert all(len(fact) == 1 for fact in goal[1:])


@pytest.mark.slow
def test_every_fact_is_declared_once_can_come_true_and_is_asked_for() -> None:
    for _, program in random_programs(60):
        text = read(program)
        facts = [fact for (fact,) in text.section(":predicates")]
        assert len(set(facts)) == len(facts)
        steps = text.steps.values()
        conditions = [c for step in steps for _, c in step.conditions]
        effects = [e for step in steps for _, e in step.effects]
        timed_ones = [literal[2] for literal in text.section(":init") if literal[0] == "at"]
        initial = [literal for literal in text.section(":init") if len(literal) == 1]
        asked = {c[0] for c in (*conditions, *text.section(":goal")[0][1:]) if len(c) == 1}
        true = {e[0] for e in (*effects, *timed_ones, *initial) if len(e) == 1}
        false = {e[1][0] for e in (*effects, *timed_ones) if e[0] == "not"}
        assert asked == true == set(facts)
        assert false <= set(facts)


def test_every_operator_happens_at_most_once() -> None:
    for _, program in random_programs(40):
        for step in read(program).steps.values():
            start = "at start" if step.durative else "now"
            (todo,) = [fact for fact in step.needs(start) if fact.startswith("todo_")]
            assert todo in step.deletes(start)


def test_what_is_taken_at_the_start_is_given_back_at_the_end() -> None:
    for _, program in random_programs(40):
        for step in read(program).steps.values():
            held = [fact for fact in step.needs("at start") if fact.startswith("free_")]
            assert held == [f for f in step.deletes("at start") if f.startswith("free_")]
            assert held == [f for f in step.adds("at end") if f.startswith("free_")]
            taken = [c[1:] for _, c in step.conditions if c[0] == ">="]
            for word, when in (("decrease", "at start"), ("increase", "at end")):
                assert taken == [e[1:] for w, e in step.effects if e[0] == word and w == when]


@pytest.mark.slow
def test_every_name_in_the_text_is_told_in_the_manifest() -> None:
    for task, program in random_programs(40):
        text, names = read(program), program.names
        assert set(text.steps) == names["actions"].keys() | names["planner_only"].keys()
        assert {m["action"] for m in names["actions"].values()} == {a.id for a in task.actions}
        facts = {fact for (fact,) in text.section(":predicates")}
        counters = {name for (name,) in text.section(":functions")}
        told = tuple(p.removesuffix("*") for k in names["facts"] for p in k.split(", "))
        assert all(fact.startswith(told) for fact in facts)
        assert {f for f in facts if f.startswith("free_")} | counters == set(names["tokens"])


@pytest.mark.slow
def test_planners_read_every_text(tmp_path: Path) -> None:
    kairos = pytest.importorskip("kairos")
    reader = up_reader()
    for k, (_, program) in enumerate(random_programs(18)):
        domain = kairos.parse_domain(program.files["domain.pddl"])
        kairos.parse_problem(program.files["problem.pddl"], domain)
        if k % 3 == 0:
            for name, content in program.files.items():
                (tmp_path / name).write_text(content, encoding="utf-8")
            problem = reader.parse_problem(*(str(tmp_path / name) for name in program.files))
            assert {a.name for a in problem.actions} == set(read(program).steps)


def up_reader() -> Any:
    unified_planning = pytest.importorskip("unified_planning.io")
    from unified_planning.environment import get_environment

    get_environment().credits_stream = None
    return unified_planning.PDDLReader()


# --- what becomes of each element ---------------------------------------------------------------


def test_an_action_without_more_is_todo_then_done() -> None:
    assert program_of({}).files["domain.pddl"] == (
        "(define (domain irc_task)\n"
        "  (:requirements :durative-actions)\n"
        "  (:predicates\n"
        "    (todo_a)\n"
        "    (done_a))\n"
        "  (:durative-action a\n"
        "    :parameters ()\n"
        "    :duration (= ?duration 1)\n"
        "    :condition (and (at start (todo_a)))\n"
        "    :effect (and (at start (not (todo_a))) (at end (done_a)))))\n"
    )


def test_nothing_to_do_is_a_problem_without_goals() -> None:
    program = compile_task(Task.model_validate({"actions": []}), "pddl21")
    text = read(program)
    assert text.section(":goal") == [["and"]]
    assert text.section(":init") == []
    assert program.decode("; Plan found with metric 0\n").entries == ()


def test_a_milestone_is_an_instant() -> None:
    text = read(program_of({"duration": 0}, {}, precedence=[["a", "b"]]))
    assert not text.steps["a"].durative
    assert text.steps["a"].adds("now") == ["done_a"]
    assert "done_a" in text.steps["b"].needs("at start")


@pytest.mark.parametrize(
    ("kind", "point", "when", "fact"),
    [
        ("finish-start", "b", "at start", "done_a"),
        ("start-start", "b", "at start", "begun_a"),
        ("finish-finish", "b", "at end", "done_a"),
        ("start-finish", "b", "at end", "begun_a"),
    ],
)
def test_a_precedence_is_a_condition_of_its_second_point(
    kind: str, point: str, when: str, fact: str
) -> None:
    edge = {"before": "a", "after": "b", "type": kind}
    steps = read(program_of({}, {}, precedence=[edge])).steps
    assert fact in steps[point].needs(when)
    assert fact in steps["a"].adds("at end" if fact.startswith("done") else "at start")


@pytest.mark.parametrize("kind", ["finish-start", "start-start", "finish-finish", "start-finish"])
def test_a_minimum_lag_is_a_wait_between_the_points(kind: str) -> None:
    edge = {"before": "a", "after": "b", "type": kind, "min_lag": 6}
    steps = read(program_of({}, {}, precedence=[edge])).steps
    (wait,) = steps.keys() - {"a", "b"}
    assert steps[wait].duration == ["=", "?duration", "3"]  # One tick is 2 s.
    reached = "done_a" if kind.startswith("finish") else "begun_a"
    assert reached in steps[wait].needs("at start")
    (over,) = steps[wait].adds("at end")
    assert over in steps["b"].needs("at end" if kind.endswith("finish") else "at start")


def test_equal_waits_behind_one_point_are_one() -> None:
    edges = [{"before": "a", "after": after, "min_lag": 4} for after in "bc"]
    steps = read(program_of({}, {}, {}, precedence=edges)).steps
    assert len(steps) == 4


@pytest.mark.parametrize(
    ("edge", "first", "second"),
    [
        # (envelope begins before, still runs at): the second point is at most 4 s later.
        ({"max_lag": 4}, ("a", "at end"), ("b", "at start")),
        ({"max_lag": 4, "type": "start-start"}, ("a", "at start"), ("b", "at start")),
        ({"max_lag": 4, "type": "finish-finish"}, ("a", "at end"), ("b", "at end")),
        ({"max_lag": 4, "type": "start-finish"}, ("a", "at start"), ("b", "at end")),
        ({"min_lag": -4}, ("b", "at start"), ("a", "at end")),
        ({"min_lag": -4, "type": "start-start"}, ("b", "at start"), ("a", "at start")),
    ],
)
def test_a_maximum_lag_is_an_envelope_around_both_points(
    edge: Document, first: tuple[str, str], second: tuple[str, str]
) -> None:
    program = program_of({}, {}, precedence=[{"before": "a", "after": "b", **edge}])
    steps, names = read(program).steps, program.names
    (name,) = steps.keys() - {"a", "b"}
    scale, slack = names["planner_units_per_tick"], names["slack"]
    low, high = (bound[2] for bound in steps[name].duration[1:])
    assert (low, high) == ("0", str(2 * scale + slack))
    begun, running = steps[name].adds("at start")
    assert steps[name].deletes("at end") == [running]
    assert begun in steps[first[0]].needs(first[1])
    assert running in steps[second[0]].needs(second[1])
    assert "is at most 2 ticks after" in names["planner_only"][name]


def test_points_that_must_coincide_meet_while_one_envelope_runs() -> None:
    """PDDL separates happenings, so neither waits for the other."""
    edge = {"before": "a", "after": "b", "type": "start-start", "max_lag": 0}
    program = program_of({}, {"duration": 4}, precedence=[edge])
    steps = read(program).steps
    (meeting,) = steps.keys() - {"a", "b"}
    assert steps[meeting].duration[2][2] == str(program.names["slack"])
    (running,) = steps[meeting].deletes("at end")
    assert all(running in steps[name].needs("at start") for name in "ab")
    assert not [f for f in steps["b"].needs("at start") if f.startswith("begun_")]


def test_a_circle_of_three_that_coincide_has_envelopes_and_the_way_in_stays_a_condition() -> None:
    edges = [{"before": x, "after": y, "type": "start-start"} for x, y in ("ab", "bc", "ca")]
    steps = read(program_of({}, {}, {}, {}, precedence=[*edges, ["d", "a"]])).steps
    assert len(steps) == 4 + 3
    assert "done_d" in steps["a"].needs("at start")


@pytest.mark.parametrize("lag", [2, -2])
def test_a_range_is_a_duration_inequality(lag: int) -> None:
    program = program_of({"duration": {"min": 2, "max": 6}})
    assert read(program).steps["a"].duration == [
        *("and", [">=", "?duration", "1"], ["<=", "?duration", "3"])
    ]


def test_a_release_opens_a_window_and_a_deadline_closes_one() -> None:
    program = program_of({"release": 4, "deadline": 8})
    text, names = read(program), program.names
    scale, slack = names["planner_units_per_tick"], names["slack"]
    assert ["at", str(2 * scale), ["released_2"]] in text.section(":init")
    assert ["at", str(4 * scale + slack), ["not", ["open_4"]]] in text.section(":init")
    assert ["open_4"] in text.section(":init")
    assert "released_2" in text.steps["a"].needs("at start")
    assert text.steps["a"].needs("over all") == ["open_4"]


def test_a_fixed_start_is_a_window_of_one_instant() -> None:
    program = program_of({"start": 4})
    text = read(program)
    scale, slack = program.names["planner_units_per_tick"], program.names["slack"]
    assert {"released_2", "open_2"} <= set(text.steps["a"].needs("at start"))
    times = {literal[1] for literal in text.section(":init") if literal[0] == "at"}
    assert times == {str(2 * scale), str(2 * scale + slack)}


def test_a_latest_start_closes_a_window_at_the_start_alone() -> None:
    program = program_of({"latest_start": 4})
    text = read(program)
    scale, slack = program.names["planner_units_per_tick"], program.names["slack"]
    (literal,) = [part for part in text.section(":init") if part[0] == "at"]
    assert literal[1] == str(2 * scale + slack)
    assert "open_2" in text.steps["a"].needs("at start")
    assert text.steps["a"].needs("over all") == []


def test_the_deadline_of_the_task_binds_everybody_and_milestones_at_their_instant() -> None:
    text = read(program_of({}, {"duration": 0}, {"deadline": 6}, deadline=10))
    assert text.steps["a"].needs("over all") == ["open_5"]
    assert "open_5" in text.steps["b"].needs("now")
    assert text.steps["c"].needs("over all") == ["open_3"]


# --- resources ----------------------------------------------------------------------------------


def variants(program: Program, action: str) -> list[list[str]]:
    """The tokens that each operator of an action takes."""
    steps = read(program).steps
    return [
        [fact for fact in steps[name].needs("at start") if fact.startswith("free_")]
        for name, meaning in program.names["actions"].items()
        if meaning["action"] == action
    ]


def test_capacity_is_one_token_for_each_unit() -> None:
    program = program_of(power(2), power(2), power(1))
    tokens = ["free_power_1", "free_power_2", "free_power_3"]
    assert [
        literal[0] for literal in read(program).section(":init") if "free" in literal[0]
    ] == tokens
    assert variants(program, "a") == [tokens[:2], tokens[::2], tokens[1:]]
    assert variants(program, "c") == [[token] for token in tokens]


def test_what_nobody_contends_for_needs_no_tokens() -> None:
    assert variants(program_of(power(2), power(1)), "a") == [[]]


def test_a_pool_of_equal_robots_is_one_resource_of_two_units() -> None:
    program = program_of(EITHER, EITHER, EITHER)
    assert variants(program, "a") == [["free_r1_r2_1"], ["free_r1_r2_2"]]
    meanings = program.names["actions"].values()
    assert {use for m in meanings for use in m["uses"].values()} == {"r1|r2"}


def test_robots_that_can_be_told_apart_are_named_in_the_operators() -> None:
    program = program_of(EITHER, {"uses": [{"resource": "r1"}]}, {"uses": [{"resource": "r2"}]})
    uses = {n: m["uses"] for n, m in program.names["actions"].items() if m["action"] == "a"}
    assert uses == {"a__r1_1": {"0": "r1"}, "a__r2_1": {"0": "r2"}}


def crowd(capacity: int, amount: int, users: int = 3) -> Task:
    return Task.model_validate(
        {
            "resources": [{"id": "crew", "capacity": capacity}],
            "actions": [
                {"id": f"a{k}", "duration": 1, "uses": [{"resource": "crew", "amount": amount}]}
                for k in range(users)
            ],
        }
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("capacity", "amount", "operators_each"),
    [(10, 5, 252), (16, 15, 16), (3, 2, 3), (11, 5, None), (20, 10, None), (100, 60, None)],
)
def test_tokens_within_their_budget_and_a_counter_beyond_it(
    capacity: int, amount: int, operators_each: int | None
) -> None:
    program = compile_task(crowd(capacity, amount), "pddl21")
    text = read(program)
    if operators_each is not None:
        assert operators_each <= MAX_VARIANTS
        assert len(variants(program, "a0")) == operators_each
        assert text.section(":functions") == []
        return
    assert variants(program, "a0") == [[]]
    assert text.section(":functions") == [["left_of_crew"]]
    assert ["=", ["left_of_crew"], str(capacity)] in text.section(":init")
    conditions = [c for _, c in text.steps["a0"].conditions]
    assert [">=", ["left_of_crew"], str(amount)] in conditions


def test_claims_of_one_action_on_one_resource_add_up() -> None:
    twice = {"uses": [{"resource": "power"}, {"resource": "power", "amount": 2}]}
    assert variants(program_of(twice, power(1), power(1)), "a") == [
        ["free_power_1", "free_power_2", "free_power_3"]
    ]


def test_too_many_choices_are_refused_with_their_place() -> None:
    robots = [{"id": f"r{k}"} for k in range(40)]
    sides = [[f"r{k}" for k in range(20)], [f"r{k}" for k in range(15, 40)]]
    actions = [
        {"id": f"a{k}", "duration": 1, "uses": [{"one_of": side} for side in sides]}
        for k in range(30)
    ]
    with pytest.raises(InputError) as refused:
        compile_task(Task.model_validate({"resources": robots, "actions": actions}), "pddl21")
    (told,) = refused.value.report
    assert (told.code.id, told.pointer) == ("IRC502", ("actions", 0, "uses"))
    assert "more than 256 ways to choose its resources" in told.message


# --- scale and slack ----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("epsilon", [EPSILON, Fraction(1, 10)])
def test_all_slack_together_stays_below_one_tick(epsilon: Fraction) -> None:
    bounded = 0
    for task, program in random_programs(60):
        problem = program.problem
        grounded = encode(problem, epsilon)
        envelopes = sum(name.startswith("keep_") for name in grounded.planner_only)
        windows = sum(
            problem.effective_deadline(i) is not None or a.start is not None
            for i, a in enumerate(problem.activities)
        )
        if not envelopes and not windows:
            assert (grounded.scale, grounded.slack) == (1, 0)
            continue
        happenings = 2 * (len(problem.activities) + len(grounded.planner_only))
        assert grounded.slack >= epsilon * happenings
        assert grounded.slack * (envelopes + windows) < grounded.scale, task
        bounded += 1
    assert bounded > 20


def test_without_bounds_from_above_one_tick_is_one_unit() -> None:
    program = program_of({"release": 4}, {"duration": 58_000_000}, precedence=[["a", "b"]])
    assert (program.names["planner_units_per_tick"], program.names["slack"]) == (1, 0)
    assert read(program).steps["b"].duration == ["=", "?duration", str(29_000_000)]


# --- the way back -------------------------------------------------------------------------------


def fits(program: Program, uses: dict[str, str], action: str, held: dict[str, int]) -> bool:
    """Whether an operator's choices are those of an action that holds these amounts."""
    problem = program.problem
    members = {s.id: [problem.resources[m].id for m in s.members] for s in problem.contention.pools}
    (activity,) = [a for a in problem.activities if a.id == action]
    taken = Counter[str]()
    for claim in activity.open_demands:
        pool = members[uses[str(claim.use)]]
        taken[pool[0] if len(pool) == 1 else ""] += claim.amount
        if held.keys().isdisjoint(pool):
            return False
    return all(amount <= held[resource] for resource, amount in taken.items() if resource)


def plan_of(program: Program, best: Optimum) -> str:
    """A schedule as a planner would print it, with the operators that its choices stand for."""
    unit = program.names["planner_units_per_tick"] / program.problem.tick
    lines = []
    for action, began in best.starts.items():
        name = next(
            name
            for name, meaning in program.names["actions"].items()
            if meaning["action"] == action
            and fits(program, meaning.get("uses", {}), action, best.resources[action])
        )
        length = (best.ends[action] - began) * unit
        lines.append(f"{float(began * unit):.3f}: ({name}) [{float(length):.3f}]")
    return "\n".join(random.Random(0).sample(lines, len(lines))) + "\n"


@pytest.mark.slow
def test_a_plan_is_read_back_as_the_schedule_it_stands_for() -> None:
    compared = 0
    for task, program in random_programs(90):
        best = optimal_schedule(task)
        if best is None:
            continue
        schedule = program.decode(plan_of(program, best))
        assert validate(task, schedule).valid
        assert schedule.makespan == best.makespan
        compared += 1
    assert compared > 60


@pytest.mark.parametrize(
    ("plan", "reason"),
    [
        ("", "there is no plan in the text"),
        ("; Problem Unsolvable", "its word is not a proof"),
        ("0.000: (a) [1.000]\n", "'b' is missing"),
        ("0.000: (b) [1.000]\n2.000: (a) [1.000]\n0.000: (c) [1.000]\n", "has no action 'c'"),
        ("0.000: (a) [1.000]\n2.000: (a) [1.000]\n2.000: (b) [1.000]\n", "'a' happens twice"),
        ("0.000: (a x) [1.000]\n2.000: (b) [1.000]\n", "has no action 'a'"),
    ],
)
def test_a_plan_that_cannot_be_used_is_refused_with_a_reason(plan: str, reason: str) -> None:
    program = program_of({}, {}, precedence=[["a", "b"]])
    with pytest.raises(AnswerError, match=re.escape(reason)):
        program.decode(plan)


def test_helpers_in_a_plan_are_passed_over() -> None:
    edge = {"before": "a", "after": "b", "min_lag": 4}
    program = program_of({}, {}, precedence=[edge])
    (wait,) = program.names["planner_only"]
    plan = f"0.000: (a) [1.000]\n1.001: ({wait}) [2.000]\n3.002: (b) [1.000]\n"
    assert [(e.id, e.start) for e in program.decode(plan).entries] == [("a", 0), ("b", 6)]


# --- names --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("boil", "boil"),
        ("Boil Water", "boil_water"),
        ("straße", "strae"),
        ("Crème brûlée", "creme_brulee"),
        ("日本語", "x"),
        ("", "x"),
        ("1st", "x1st"),
        ("_a_", "a"),
        ("a__b", "a__b"),
        ("not", "not_2"),
        ("total-time", "total_time"),
        ("done_x", "xdone_x"),
        ("a) (:action b", "a_action_b"),
        ("n" * 300, "n" * 48),
    ],
)
def test_a_name_reads_like_its_text(text: str, name: str) -> None:
    assert NameTable().new(text) == name


def test_equal_readings_are_numbered_in_order() -> None:
    table = NameTable()
    assert [table.new(text) for text in ("a b", "a-b", "A_B", "a_b_2", "日", "本")] == [
        *("a_b", "a_b_2", "a_b_3", "a_b_2_2", "x", "x_2")
    ]


def test_no_name_is_a_keyword() -> None:
    table = NameTable()
    assert not RESERVED & {table.new(word) for word in RESERVED}


def test_many_equal_readings_take_little_time() -> None:
    table = NameTable()
    assert len({table.new("日本語") for _ in range(50_000)}) == 50_000
