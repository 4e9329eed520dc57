"""The PDDL importer: quantifiers, disjunctions, conditional effects, durations, metrics, order.

What is compiled away is judged by the optimum that is left: it is that of the original.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

import irc
from irc.diagnostics import Code, InputError
from irc.frontends.importers.pddl import import_pddl, read_pddl
from irc.model import Task
from irc.schedule import Status
from paths import SHARED_DATA

DOMAIN = """(define (domain rooms)
  (:types room box - object  heavy light - box)
  (:constants hall - room)
  (:predicates (lit ?r - room) (in ?b - box ?r - room) (open ?r - room) (clean ?r - room)
               (done) (alarm) (other))
  (:functions (size ?r - room) (total-cost) (effort))
  (:durative-action light
    :parameters (?r - room) :duration (= ?duration 2)
    :condition (at start (not (lit ?r))) :effect (at end (lit ?r)))
  (:durative-action finish
    :parameters () :duration (= ?duration 3)
    :condition CONDITION
    :effect EFFECT))"""
PROBLEM = """(define (problem p) (:domain rooms)
  (:objects a b - room h - heavy l - light)
  (:init (in h a) (in l b) (open hall) (= (size a) 1) (= (size b) 5) (= (size hall) 2))
  (:goal GOAL) METRIC)"""


def rooms(
    condition: str = "(at start (open hall))",
    effect: str = "(at end (done))",
    goal: str = "(done)",
    *,
    metric: str = "",
    init: str = "",
    more: str = "",
) -> Task:
    domain = DOMAIN.replace("CONDITION", condition).replace("EFFECT", effect)
    domain = domain[:-1] + more + ")"
    problem = PROBLEM.replace("GOAL", goal).replace("METRIC", metric)
    return import_pddl(
        (domain, "d.pddl"), (problem.replace("(open hall)", f"(open hall) {init}"), "p.pddl")
    )


def optimum(task: Task) -> Any:
    schedule = irc.solve(task, "cpsat", time_limit=60)
    assert schedule.status is Status.OPTIMAL, schedule
    return schedule.makespan


@pytest.mark.parametrize(
    ("condition", "makespan"),
    [
        ("(at start (forall (?r - room) (lit ?r)))", 5),
        ("(at start (exists (?r - room) (lit ?r)))", 5),
        ("(at start (exists (?r - room) (open ?r)))", 3),
        ("(at start (forall (?r - room) (not (lit ?r))))", 3),
        ("(at start (not (exists (?r - room) (lit ?r))))", 3),
        ("(at start (or (lit a) (lit b)))", 5),
        ("(at start (or (open hall) (lit b)))", 3),
        ("(at start (imply (open a) (lit a)))", 3),
        ("(at start (imply (open hall) (lit hall)))", 5),
        ("(at start (forall (?r - room) (imply (not (= ?r hall)) (lit ?r))))", 5),
        ("(at start (forall (?b - (either heavy light)) (exists (?r - room) (in ?b ?r))))", 3),
        ("(at start (and (or (lit a) (alarm)) (or (lit b) (alarm))))", 5),
        ("(over all (or (lit a) (open hall)))", 3),
        ("(over all (or (lit a) (alarm)))", 5),
        ("(at end (or (lit a) (alarm)))", 3),  # Lit at 2, before the end at 3.
        ("(at start (>= (size b) 5))", 3),
        ("(at start (< (+ (size a) (size hall)) (size b)))", 3),
        ("(and)", 3),
    ],
)
def test_conditions_mean_what_they_say(condition: str, makespan: int) -> None:
    # (Constants of the problem are named in the domain: its objects are declared there.)
    assert optimum(in_constants(condition)) == makespan


def in_constants(condition: str, **options: str) -> Task:
    domain = DOMAIN.replace("hall - room)", "hall a b - room)").replace("CONDITION", condition)
    domain = domain.replace("EFFECT", options.get("effect", "(at end (done))"))
    domain = domain[:-1] + options.get("more", "") + ")"
    problem = PROBLEM.replace("GOAL", options.get("goal", "(done)")).replace("METRIC", "")
    problem = problem.replace("a b - room ", "").replace(
        "(open hall)", options.get("init", "(open hall)")
    )
    return import_pddl((domain, "d.pddl"), (problem, "p.pddl"))


def test_a_false_condition_leaves_no_plan() -> None:
    with pytest.raises(InputError, match=r"goal \(done\) can never hold"):
        rooms("(at start (< (size hall) (size hall)))")


@pytest.mark.parametrize(
    ("effect", "goal", "makespan"),
    [
        ("(forall (?r - room) (at end (clean ?r)))", "(forall (?r - room) (clean ?r))", 3),
        ("(when (at start (open hall)) (at end (done)))", "(done)", 3),
        ("(when (at start (lit hall)) (at end (done)))", "(done)", 5),
        ("(at end (when (lit hall) (done)))", "(done)", 3),
        ("(at end (when (not (lit hall)) (done)))", "(done)", 3),
        ("(at end (when (or (lit hall) (alarm)) (done)))", "(done)", 3),
        # Each room that is lit becomes clean: all are lit first, or at least before the end.
        (
            "(at end (forall (?r - room) (when (lit ?r) (clean ?r))))",
            "(forall (?r - room) (clean ?r))",
            3,
        ),
        (
            "(forall (?r - room) (when (at start (lit ?r)) (at end (clean ?r))))",
            "(and (clean hall) (clean a))",
            5,
        ),
        ("(and (at end (done)) (at end (when (lit hall) (alarm))))", "(and (done) (alarm))", 3),
        ("(and (at end (done)) (at end (when (lit hall) (alarm))))", "(done)", 3),
    ],
)
def test_effects_mean_what_they_say(effect: str, goal: str, makespan: int) -> None:
    assert optimum(rooms(effect=effect, goal=goal)) == makespan


@pytest.mark.parametrize(
    ("goal", "makespan"),
    [
        ("(or (done) (lit hall))", 2),
        ("(exists (?r - room) (lit ?r))", 2),
        ("(and (done) (or (lit a) (lit b)))", 3),
        ("(imply (done) (lit a))", 0),
        ("(and)", 0),
    ],
)
def test_goals_may_be_disjunctions(goal: str, makespan: int) -> None:
    assert optimum(rooms(goal=goal)) == makespan


def test_a_disjunction_may_change_its_reason_while_it_holds() -> None:
    """First the lamp of the hall, then the other one: at every instant one of them is lit."""
    more = """(:durative-action darken :parameters (?r - room) :duration (= ?duration 1)
        :condition (at start (lit ?r)) :effect (and (at end (not (lit ?r))) (at end (clean ?r))))"""
    task = in_constants(
        "(over all (or (lit a) (lit b)))",
        goal="(and (done) (clean a) (not (lit a)))",
        init="(open hall) (lit a)",
        more=more,
    )
    # b is lit from 2 on; a becomes dark at 2 or later, and finish may begin at 0 all the same.
    assert optimum(task) == 3


def test_variants_of_an_action_have_one_name_in_plans() -> None:
    task = in_constants("(at start (or (lit a) (lit b)))")
    assert [a.id for a in task.actions if "finish" in a.id] == ["(finish)", "(finish) #2"]


@pytest.mark.parametrize(
    ("duration", "expected"),
    [
        ("(<= ?duration 4)", "min=0 max=4"),
        ("(and (>= ?duration 2) (<= ?duration 4))", "min=2 max=4"),
        ("(>= ?duration 2)", "min=2 max=7"),
        ("(and (>= ?duration 2) (>= ?duration 3) (<= ?duration 9))", "min=3 max=9"),
        ("(at start (= ?duration 4))", "4"),
        ("(= 4 ?duration)", "4"),
    ],
)
def test_durations_may_have_one_bound(duration: str, expected: str) -> None:
    domain = DOMAIN.replace("(= ?duration 3)", duration)
    domain = domain.replace("CONDITION", "(at start (lit hall))").replace(
        "EFFECT", "(at end (done))"
    )
    problem = PROBLEM.replace("GOAL", "(done)").replace("METRIC", "")
    task = import_pddl((domain, "d.pddl"), (problem, "p.pddl"))
    (finish,) = [a for a in task.actions if a.id == "(finish)"]
    assert str(finish.duration) == expected


def test_a_metric_of_costs_is_the_objective() -> None:
    effect = "(and (at end (done)) (at end (increase (total-cost) 2.5)))"
    more = """(:durative-action cheat :parameters () :duration (= ?duration 9)
        :condition (and) :effect (and (at end (done)) (at start (increase (total-cost) 1))
        (at end (increase (effort) (* ?duration 2)))))"""
    task = rooms(effect=effect, metric="(:metric minimize (total-cost))", more=more)
    assert task.objective == ("minimize_cost",)
    assert {a.id: a.cost for a in task.actions} == {"(finish)": 5, "(cheat)": 2}
    assert task.metadata["pddl"]["cost_per_unit_of_the_metric"] == 2
    task = rooms(
        effect=effect, metric="(:metric minimize (+ (* 2 (total-cost)) (effort)))", more=more
    )
    assert {a.id: a.cost for a in task.actions} == {"(finish)": 5, "(cheat)": 20}
    task = rooms(effect=effect, metric="(:metric maximize (total-cost))", more=more)
    assert {a.id: a.cost for a in task.actions} == {"(finish)": -5, "(cheat)": -2}
    assert rooms(effect=effect, metric="(:metric minimize (total-time))", more=more).objective == (
        "minimize_makespan",
    )


def test_a_metric_of_time_and_cost_is_read_with_a_warning() -> None:
    effect = "(and (at end (done)) (at end (increase (total-cost) 2)))"
    domain = DOMAIN.replace("CONDITION", "(and)").replace("EFFECT", effect)
    metric = "(:metric minimize (+ (* 4 (total-time)) (total-cost)))"
    problem = PROBLEM.replace("GOAL", "(done)").replace("METRIC", metric)
    task, report = read_pddl((domain, "d.pddl"), (problem, "p.pddl"))
    assert task.objective == ("minimize_makespan", "minimize_cost")
    (warning,) = report.located()
    assert (warning.code, warning.line) == (Code.LENIENT, 4)


# --- numbers ------------------------------------------------------------------------------------

TANK = """(define (domain tank)
  (:predicates (made) (full) (calm))
  (:functions (level) (size) (work))
  (:durative-action fill :parameters () :duration (= ?duration 2)
    :condition (at start (< (level) (size))) :effect (at end (increase (level) 5)))
  (:durative-action use :parameters () :duration (= ?duration 3)
    :condition (and (at start (>= (level) 7)) (at start (calm)))
    :effect (and (at start (decrease (level) 7)) (at end (made)) (at end (increase (work) 1))))
  (:durative-action empty :parameters () :duration (= ?duration 1)
    :condition (over all (> (level) 0)) :effect (at end (assign (level) 0))))"""


def tank(level: int, goal: str) -> Task:
    problem = f"""(define (problem p) (:domain tank)
      (:init (calm) (= (level) {level}) (= (size) 12) (= (work) 0)) (:goal {goal}))"""
    return import_pddl((TANK, "d.pddl"), (problem, "p.pddl"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "goal", "makespan"),
    [(9, "(made)", 3), (3, "(made)", 5), (0, "(>= (level) 11)", 6), (0, "(not (>= (level) 5))", 0)],
)
def test_numbers_that_conditions_read_are_counted(level: int, goal: str, makespan: int) -> None:
    assert optimum(tank(level, goal)) == makespan


def test_a_number_is_a_number_variable_and_its_actions_stay_one_each() -> None:
    task = tank(3, "(and (made) (>= (level) 1) (not (> (level) 4)))")
    assert [a.id for a in task.actions] == ["(fill)", "(use)", "(empty)"]
    (level,) = (v for v in task.state if v.is_number)
    assert (level.id, level.initial, level.min, level.max) == ("(level)", 3, None, None)
    fill, use, empty = task.actions
    assert [(e.var, e.set) for e in empty.effects] == [("(level)", 0)]
    assert [(c.var, *c.limits) for c in fill.conditions] == [("(level)", None, 11)]
    assert [(e.var, e.at, e.add) for e in fill.effects] == [("(level)", "end", 5)]
    assert [c.limits for c in use.conditions if c.var == "(level)"] == [(7, None)]
    asked = [goal for goal in task.goals if not isinstance(goal, str) and goal.var == "(level)"]
    assert [goal.limits for goal in asked] == [(1, 4)]


def test_strict_limits_know_the_steps_of_a_number() -> None:
    problem = """(define (problem p) (:domain tank)
      (:init (calm) (= (level) 0.5) (= (size) 12) (= (work) 0)) (:goal (> (level) 10)))"""
    task = import_pddl((TANK, "d.pddl"), (problem, "p.pddl"))
    (goal,) = task.goals
    assert not isinstance(goal, str)
    assert goal.limits == (Fraction(21, 2), None)
    fill = task.actions[0]
    assert [c.limits for c in fill.conditions] == [(None, Fraction(23, 2))]


@pytest.mark.slow
def test_two_numbers_that_change_are_compared_by_their_difference() -> None:
    domain = TANK.replace("(>= (level) 7)", "(>= (- (level) 6) (* 2 (work)))")
    domain = domain.replace("(:durative-action empty", "(:durative-action shut").replace(
        "(assign (level) 0)", "(decrease (level) 1)"
    )
    problem = """(define (problem p) (:domain tank)
      (:init (calm) (= (level) 0) (= (size) 99) (= (work) 0)) (:goal (>= (work) 2)))"""
    task = import_pddl((domain, "d.pddl"), (problem, "p.pddl"))
    names = {v.id for v in task.state if v.is_number}
    assert names == {"(+ (level) (* -2 (work)))", "(work)", "(level)"}
    # The first use needs 6, so two fills; 3 are left, one more fill makes the 8 of the second one.
    assert optimum(task) == 10


def test_a_number_without_a_value_at_first_is_counted() -> None:
    problem = """(define (problem p) (:domain tank)
      (:init (calm) (= (size) 12) (= (work) 0)) (:goal (made)))"""
    domain = TANK.replace("(over all (> (level) 0))", "(at start (calm))")
    task = import_pddl((domain, "d.pddl"), (problem, "p.pddl"))
    fills = [a for a in task.actions if a.id.startswith("(fill)")]
    values = [c.var for a in fills for c in a.conditions if c.var.startswith("(= ")]
    assert len(values) == len(set(values)) == len(fills) > 1
    assert "(= (level) 15)" not in values  # There the tank is full.
    assert {use.resource for a in fills for use in a.uses} == {"(fill)"}


def test_a_number_with_many_values_costs_nothing() -> None:
    domain = TANK.replace("(increase (level) 5)", "(increase (level) 0.01)")
    problem = """(define (problem p) (:domain tank)
      (:init (calm) (= (level) 0) (= (size) 12) (= (work) 0)) (:goal (made)))"""
    task = import_pddl((domain, "d.pddl"), (problem, "p.pddl"))
    assert [a.id for a in task.actions] == ["(fill)", "(use)", "(empty)"]


@pytest.mark.parametrize(
    ("old", "new", "first", "message", "line"),
    [
        ("(increase (level) 5)", "(increase (level) 0.01)", "", "more than 200 values", 5),
        ("(>= (level) 7)", "(<= (level) (work))", "(= (level) 0)", "more than 200 values", 7),
        ("(increase (level) 5)", "(increase (level) (work))", "(= (level) 0)", "on (work)", 5),
        ("(increase (level) 5)", "(scale-up (level) 5)", "(= (level) 0)", "other than", 5),
        ("(increase (level) 5)", "(increase (level) (* #t 5))", "(= (level) 0)", "continuous", 5),
    ],
)
def test_numbers_that_cannot_be_read_are_refused_with_their_line(
    old: str, new: str, first: str, message: str, line: int
) -> None:
    problem = f"""(define (problem p) (:domain tank)
      (:init (calm) {first} (= (size) 12) (= (work) 0)) (:goal (made)))"""
    assert old in TANK
    with pytest.raises(InputError) as refused:
        import_pddl((TANK.replace(old, new), "d.pddl"), (problem, "p.pddl"))
    found = refused.value.report.located()
    assert any(message in d.message for d in found), found
    assert any(d.line in (line, line + 1, line - 1) for d in found), [d.line for d in found]


def test_two_numbers_that_change_are_compared() -> None:
    """What is built first is sold: the second sale waits for the second piece."""
    domain = """(define (domain shop) (:requirements :durative-actions :fluents)
      (:functions (built) (sold))
      (:durative-action build :parameters () :duration (= ?duration 2)
        :condition (at start (< (built) 3)) :effect (at end (increase (built) 1)))
      (:durative-action sell :parameters () :duration (= ?duration 1)
        :condition (at start (> (built) (sold))) :effect (at start (increase (sold) 1))))"""
    problem = """(define (problem p) (:domain shop)
      (:init (= (built) 0) (= (sold) 0)) (:goal (>= (sold) 2)))"""
    task = import_pddl((domain, "d.pddl"), (problem, "p.pddl"))
    assert optimum(task) == 2 * 2 + 1


BATTERY = """(define (domain rover)
  (:requirements :durative-actions :fluents)
  (:predicates (sent))
  (:functions (energy) (rate))
  (:durative-action charge :parameters () :duration (= ?duration (/ (- 80 (energy)) (rate)))
    :condition (at start (< (energy) 80))
    :effect (at end (increase (energy) (* ?duration (rate)))))
  (:durative-action drive :parameters () :duration (= ?duration 1)
    :condition (at start (>= (energy) 20)) :effect (at start (decrease (energy) 20)))
  (:durative-action send :parameters () :duration (= ?duration 1)
    :condition (at start (>= (energy) 70)) :effect (at end (sent))))"""


@pytest.mark.parametrize(("energy", "makespan"), [(80, 1), (60, 3), (30, 6)])
def test_a_duration_that_depends_on_a_number_is_an_action_for_each_value(
    energy: int, makespan: int
) -> None:
    problem = f"""(define (problem p) (:domain rover)
      (:init (= (energy) {energy}) (= (rate) 10)) (:goal (sent)))"""
    task = import_pddl((BATTERY, "d.pddl"), (problem, "p.pddl"))
    assert optimum(task) == makespan


def test_an_action_of_no_length_is_an_instant_unless_its_start_touches_its_end() -> None:
    domain = """(define (domain d) (:requirements :durative-actions) (:predicates (a) (b) (c))
      (:durative-action one :parameters () :duration (= ?duration 0)
        :condition (at start (a)) :effect (at end (b)))
      (:durative-action two :parameters () :duration (= ?duration 0)
        :condition (and (at start (b)) (at end (c))) :effect (at start (c))))"""
    problem = "(define (problem p) (:domain d) (:init (a)) (:goal GOAL))"
    task = import_pddl(
        (domain.split("(:durative-action two")[0] + ")", "d.pddl"),
        (problem.replace("GOAL", "(b)"), "p.pddl"),
    )
    assert [action.id for action in task.actions] == ["(one)"]
    with pytest.raises(InputError, match="a length must be more than 0"):
        import_pddl((domain, "d.pddl"), (problem.replace("GOAL", "(b)"), "p.pddl"))


# --- model-written PDDL -------------------------------------------------------------------------


def habits(text: str, *, lenient: bool) -> tuple[Task, list[str]]:
    domain, problem = text.split("---")
    task, report = read_pddl((domain, "d.pddl"), (problem, "p.pddl"), lenient=lenient)
    return task, [d.message for d in report]


HABITS = {
    "object of the problem": """(define (domain d) (:predicates (on ?x) (off ?x))
        (:durative-action go :parameters () :duration (= ?duration 1)
         :condition (at start (off lamp)) :effect (at end (on lamp))))
        ---(define (problem p) (:domain d) (:objects lamp) (:init (off lamp)) (:goal (on lamp)))""",
    "missing :parameters": """(define (domain d) (:predicates (on))
        (:durative-action go :duration (= ?duration 1) :effect (at end (on))))
        ---(define (problem p) (:domain d) (:init) (:goal (on)))""",
    "another domain": """(define (domain d) (:predicates (on))
        (:durative-action go :parameters () :duration (= ?duration 1) :effect (at end (on))))
        ---(define (problem p) (:domain dd) (:init) (:goal (on)))""",
    "parenthesis too many": """(define (domain d) (:predicates (on))
        (:durative-action go :parameters () :duration (= ?duration 1) :effect (at end (on)))))
        ---(define (problem p) (:domain d) (:init) (:goal (on)))""",
}


@pytest.mark.parametrize("habit", HABITS)
def test_habits_of_models_are_read_with_a_warning_where_that_is_asked_for(habit: str) -> None:
    with pytest.raises(InputError):
        habits(HABITS[habit], lenient=False)
    task, warnings = habits(HABITS[habit], lenient=True)
    assert [a.id for a in task.actions] == ["(go)"]
    assert warnings


def test_a_constant_that_is_an_object_too_is_one_object() -> None:
    text = """(define (domain d) (:types t) (:constants lamp - t) (:predicates (on ?x - t))
        (:durative-action go :parameters (?x - t) :duration (= ?duration 1)
         :effect (at end (on ?x))))
        ---(define (problem p) (:domain d) (:objects lamp - t) (:init) (:goal (on lamp)))"""
    task, warnings = habits(text, lenient=False)
    assert [a.id for a in task.actions] == ["(go lamp)"]
    assert len(warnings) == 1


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
def test_a_domain_cut_anywhere_is_a_located_error(share: float) -> None:
    domain = DOMAIN.replace("CONDITION", "(and)").replace("EFFECT", "(at end (done))")
    problem = PROBLEM.replace("GOAL", "(done)").replace("METRIC", "")
    for cut in (
        (domain[: int(len(domain) * share)], problem),
        (domain, problem[: int(len(problem) * share)]),
    ):
        with pytest.raises(InputError) as refused:
            import_pddl((cut[0], "d.pddl"), (cut[1], "p.pddl"))
        for found in refused.value.report.located():
            assert found.line is not None or "p.pddl:" in found.message


# --- inputs that people have --------------------------------------------------------------------


@pytest.mark.shared_data
@pytest.mark.parametrize(
    ("name", "makespan"),
    [("til", 15), ("unused_adl", 5), ("order", 5), ("empty_functions", 5), ("move", 5)],
)
def test_a_case_is_read_and_solved(name: str, makespan: int) -> None:
    files = [SHARED_DATA / "cases" / f"{name}_{part}.pddl" for part in "dp"]
    task = import_pddl(*((file.read_text("utf-8"), file.name) for file in files))
    assert optimum(task) == makespan
