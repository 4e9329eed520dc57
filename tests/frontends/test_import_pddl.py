"""The PDDL importer: what is read means what it says, judged by a validator of the original.

Hand-made schedules are valid for irc and, written back as plans, for unified-planning's validator
on the original domain and problem; damaged ones are valid for neither.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import pytest

import irc
from irc.diagnostics import Code, Diagnostic, InputError
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan import PlanError, plan_text
from irc.model import Task
from irc.schedule import Entry, Schedule
from oracles.pddl_plans import Judge
from paths import EXAMPLES
from runs import run_irc

pytest.importorskip("unified_planning")

EXAMPLES = EXAMPLES / "pddl"

PLANS = {
    "matchcellar": """
        0: (light-match match1) [5]
        0: (mend-fuse fuse1) [2]
        2: (mend-fuse fuse2) [2]
        5: (light-match match2) [5]
        5: (mend-fuse fuse3) [2]
    """,
    "deliveries": """
        0: (walk ann home depot) [4]
        4: (board ann van1 depot) [0]
        4: (drive ann van1 depot market) [3.5]
        7.5: (load crate van1 market) [2.5]
        10: (drive ann van1 market depot) [3.5]
        13.5: (unload crate van1 depot) [1]
        13.5: (leave ann van1 depot) [0]
        13.5: (walk ann depot home) [4]
    """,
    "satellite": """
        0: (switch-on camera orbiter) [2]
        0: (turn-to orbiter star1 phenomenon2) [5]
        5: (calibrate orbiter camera star1) [3]
        5: (turn-to orbiter phenomenon2 star1) [5]
        10: (take-image orbiter phenomenon2 camera thermal) [7]
        17: (turn-to orbiter phenomenon3 phenomenon2) [2.5]
        19.5: (take-image orbiter phenomenon3 camera thermal) [7]
    """,
    "ferry": """
        10: (cross south north) [3]
        13: (carry red north south) [4]
        17: (cross south north) [3]
        20: (carry blue north south) [4]
    """,
}
MAKESPANS = {"matchcellar": 10, "deliveries": 17.5, "satellite": 26.5, "ferry": 24}
LINE = re.compile(r"([\d.]+): (\(.*\)) \[([\d.]+)\]")


def example(name: str) -> Task:
    files = [EXAMPLES / name / f"{part}.pddl" for part in ("domain", "problem")]
    return import_pddl(*((file.read_text("utf-8"), file.name) for file in files))


def scheduled(task: Task, plan: str) -> Schedule:
    """A plan as a schedule: its own times, each action's occurrences numbered."""
    count: dict[str, int] = {}
    entries = []
    for start, id, lasts in LINE.findall(plan):
        count[id] = count.get(id, 0) + 1
        begin = Fraction(start)
        entries.append(Entry(id, begin, begin + Fraction(lasts), occurrence=count[id]))
    return Schedule(tuple(entries))


def bare_plan(schedule: Schedule) -> str:
    """The entries with their times as they are, nothing separated."""
    lines = []
    for entry in schedule.entries:
        if entry.id.startswith("("):
            lasts = f" [{float(entry.end - entry.start)}]" if entry.end > entry.start else ""
            lines.append(f"{float(entry.start)}: {entry.id}{lasts}\n")
    return "".join(lines)


@pytest.fixture(scope="module", params=PLANS)
def case(request: pytest.FixtureRequest) -> tuple[Task, Schedule, Judge]:
    task = example(request.param)
    return task, scheduled(task, PLANS[request.param]), Judge(EXAMPLES / request.param)


# --- plans of the original ----------------------------------------------------------------------


@pytest.mark.slow
def test_a_hand_made_plan_is_valid_here_and_on_the_original_pddl(
    case: tuple[Task, Schedule, Judge], request: pytest.FixtureRequest
) -> None:
    task, schedule, judge = case
    assert not irc.check(task).errors
    verdict = irc.validate(task, schedule)
    assert verdict.valid, str(verdict)
    name = next(n for n, plan in PLANS.items() if scheduled(task, plan) == schedule)
    assert verdict.makespan == Fraction(str(MAKESPANS[name]))
    assert judge.accepts(plan_text(task, schedule))
    assert judge.finds_valid(plan_text(task, schedule))


def damaged(schedule: Schedule) -> Iterator[tuple[str, Schedule]]:
    for entry in schedule.entries:
        if not entry.id.startswith("("):
            continue
        rest = tuple(e for e in schedule.entries if e is not entry)
        yield f"without {entry.id}", Schedule(rest)
        for shift in (Fraction(-1, 2), Fraction(-4), Fraction(40)):
            if entry.start + shift >= 0:
                moved = replace(entry, start=entry.start + shift, end=entry.end + shift)
                yield f"{entry.id} moved by {shift}", Schedule((*rest, moved))
        longer = replace(entry, end=entry.end + 30)
        yield f"{entry.id} longer", Schedule((*rest, longer))


def test_a_damaged_plan_is_valid_for_neither(case: tuple[Task, Schedule, Judge]) -> None:
    task, schedule, judge = case
    rejected = 0
    for what, other in damaged(schedule):
        valid = irc.validate(task, numbered(other)).valid
        if valid:  # Some things may as well be done at another time.
            assert judge.accepts(plan_text(task, numbered(other))), what
            assert judge.finds_valid(plan_text(task, numbered(other))), what
        else:
            rejected += 1
            assert not judge.accepts(bare_plan(other)), what
            assert not judge.finds_valid(bare_plan(other)), what
    assert rejected > 2 * len(schedule.entries)


def starts_are_seen(task: Task) -> bool:
    """Whether each action that holds something changes something at its start.

    Where one does not, unified-planning's validator does not look at the state between its start
    and the next change, and so accepts what PDDL2.1 does not.
    """
    return all(
        any(effect.at == "start" for effect in action.effects)
        for action in task.actions
        if any(condition.at == "all" for condition in action.conditions)
    )


def numbered(schedule: Schedule) -> Schedule:
    """The occurrences of each action numbered by start, as a schedule wants them."""
    count: dict[str, int] = {}
    entries = []
    for entry in sorted(schedule.entries, key=lambda e: e.start):
        count[entry.id] = count.get(entry.id, 0) + 1
        entries.append(replace(entry, occurrence=count[entry.id]))
    return Schedule(tuple(entries))


@pytest.mark.slow
def test_both_agree_on_random_retimings(case: tuple[Task, Schedule, Judge]) -> None:
    """Times are moved a little, so that what depends on each other often still just fits."""
    task, schedule, judge = case
    rng = random.Random(3)
    found = {True: 0, False: 0}
    for _ in range(60):
        late = Fraction(0)
        entries = []
        for entry in schedule.entries:
            if not entry.id.startswith("("):
                entries.append(entry)
                continue
            late += rng.choice([0, 0, 0, 0, Fraction(1, 2), Fraction(1, 4)])
            early = rng.choice([0] * 9 + [Fraction(1, 4)])
            start = max(Fraction(0), entry.start + late - early)
            entries.append(replace(entry, start=start, end=start + entry.end - entry.start))
        other = numbered(Schedule(tuple(entries)))
        valid = irc.validate(task, other).valid
        found[valid] += 1
        assert judge.finds_valid(plan_text(task, other) if valid else bare_plan(other)) is valid
        if valid:
            assert judge.accepts(plan_text(task, other))
        elif starts_are_seen(task):
            assert not judge.accepts(bare_plan(other)), bare_plan(other)
    assert min(found.values()) > 1, found


# --- plans by others ----------------------------------------------------------------------------


def deliveries(rng: random.Random) -> str:
    """A random problem of the domain of deliveries: a line of places, and parcels to the depot."""
    places = ["depot", *(f"p{i}" for i in range(rng.randint(1, 3)))]
    parcels = [f"c{i}" for i in range(rng.randint(1, 2))]
    facts = [f"(at ann {rng.choice(places)})", f"(at van1 {rng.choice(places)})"]
    for one, other in [pair for a, b in pairwise(places) for pair in ((a, b), (b, a))]:
        facts += [f"(road {one} {other})", f"(path {one} {other})"]
        facts.append(f"(= (drive-time {one} {other}) {rng.choice([1, 1.5, 4])})")
        facts.append(f"(= (walk-time {one} {other}) {rng.choice([3, 5.25])})")
    for parcel in parcels:
        facts += [
            f"(at {parcel} {rng.choice(places)})",
            f"(= (weight {parcel}) {rng.randint(1, 4)})",
        ]
    goal = " ".join(f"(at {parcel} depot)" for parcel in parcels)
    return f"""(define (problem random) (:domain deliveries)
      (:objects {" ".join(places[1:])} - place ann - driver van1 - van {" ".join(parcels)} - parcel)
      (:init {" ".join(facts)})
      (:goal (and {goal} (not (taken van1)))))"""


def planned(domain: str, problem: str) -> str | None:
    """What kairos, which shares no code with the importer, does about the original."""
    kairos = pytest.importorskip("kairos")
    parsed = kairos.parse_problem(problem, kairos.parse_domain(domain))
    options = {"timeout": 10.0, "threads": 1, "seed": 0, "anytime": False}
    return next((str(plan) for plan in kairos.Planner().plans(parsed, **options)), None)


@pytest.mark.slow
def test_what_a_planner_does_about_the_original_is_a_valid_schedule() -> None:
    files = {
        name: [(EXAMPLES / name / f"{p}.pddl").read_text("utf-8") for p in ("domain", "problem")]
        for name in PLANS
    }
    rng = random.Random(5)
    cases = [(domain, problem) for domain, problem in files.values()]
    cases += [(files["deliveries"][0], deliveries(rng)) for _ in range(12)]
    tried = 0
    for domain, problem in cases:
        plan = planned(domain, problem)
        if plan is None:
            continue
        task = imported(domain, problem)
        useless = task.metadata.get("actions_that_change_nothing_that_matters", [])
        schedule = numbered(scheduled(task, plan))
        known = Schedule(tuple(e for e in schedule.entries if e.id not in useless))
        verdict = irc.validate(task, known)
        assert verdict.valid, f"{problem}\n{plan}\n{verdict}"
        tried += 1
    assert tried > 12


# --- what a domain becomes ----------------------------------------------------------------------

DOMAIN = """(define (domain d)
  (:requirements :typing :durative-actions :negative-preconditions :fluents
                 :duration-inequalities :timed-initial-literals :equality)
  (:types thing - object big small - thing)
  (:predicates (p ?x - thing) (q) (fixed ?x - thing) (seen) (r))
  (:functions (len ?x - thing))
  (:durative-action a
    :parameters (?x - thing)
    :duration (= ?duration (len ?x))
    :condition (and (at start (p ?x)) (over all (fixed ?x)) (at end (not (r))))
    :effect (and (at start (not (p ?x))) (at end (q)) (at end (seen))))
  (:action b
    :parameters (?x ?y - big)
    :precondition (and (p ?x) (not (= ?x ?y)))
    :effect (and (not (p ?x)) (p ?y))))
"""
PROBLEM = """(define (problem e) (:domain d)
  (:objects b1 b2 - big s1 - small)
  (:init (p b1) (fixed b2) (fixed s1) (= (len b2) 1.25) (= (len s1) 2))
  (:goal (q)))
"""


def imported(domain: str = DOMAIN, problem: str = PROBLEM) -> Task:
    return import_pddl((domain, "domain.pddl"), (problem, "problem.pddl"))


def test_only_what_can_happen_is_grounded() -> None:
    task = imported()
    # a needs a fixed thing that can be p: b1 is not fixed, and nothing makes s1 p.
    assert [a.id for a in task.actions] == ["(a b2)", "(b b1 b2)", "(b b2 b1)"]


def test_what_never_changes_is_decided_and_what_nobody_reads_is_left_out() -> None:
    task = imported()
    assert {v.id: v.start_value for v in task.state} == {
        "(p b1)": True,
        "(p b2)": False,
        "(q)": False,
    }
    (action,) = [a for a in task.actions if a.id == "(a b2)"]
    assert [(c.at, c.var, c.value) for c in action.conditions] == [("start", "(p b2)", True)]
    assert str(action.duration) == "5/4"


def test_an_instantaneous_action_takes_no_time() -> None:
    task = imported()
    (action,) = [a for a in task.actions if a.id == "(b b1 b2)"]
    assert action.duration == 0
    assert [(e.at, e.var, e.value) for e in action.effects] == [
        ("start", "(p b1)", False),
        ("start", "(p b2)", True),
    ]


def test_what_is_deleted_and_added_at_once_is_added() -> None:
    task = imported(DOMAIN.replace("(not (= ?x ?y))", "(= ?x ?x)"))
    (action,) = [a for a in task.actions if a.id == "(b b1 b1)"]
    assert [(e.var, e.value) for e in action.effects] == [("(p b1)", True)]


def test_an_action_that_uses_up_what_nothing_restores_happens_once_at_most() -> None:
    occurs = {a.id: a.occurs for a in example("matchcellar").actions}
    assert occurs["(light-match match1)"] == "optional"
    assert occurs["(mend-fuse fuse1)"] != "optional"


def test_required_concurrency_survives_the_pruning() -> None:
    """What one action needs at its end only another one can bring about, during it."""
    task = example("matchcellar")
    assert {a.id.split()[0] for a in task.actions} == {"(light-match", "(mend-fuse"}


def test_a_timed_initial_literal_is_a_timed_change_of_state() -> None:
    (variable,) = [v for v in example("ferry").state if v.id == "(open)"]
    assert [(c.at, c.value) for c in variable.changes] == [(10, True), (25, False)]


def test_a_range_of_durations_is_kept() -> None:
    task = example("satellite")
    (action,) = [a for a in task.actions if a.id == "(switch-on camera orbiter)"]
    assert str(action.duration) == "min=2 max=6"


def test_an_action_whose_duration_has_no_value_cannot_happen() -> None:
    with pytest.raises(InputError) as refused:
        imported(problem=PROBLEM.replace("(= (len b2) 1.25)", ""))
    (diagnostic,) = refused.value.report.located()
    assert "the goal (q) can never hold" in diagnostic.message
    assert diagnostic.line == 4


def test_upper_case_is_lower_case() -> None:
    assert imported(DOMAIN.upper().replace("DEFINE", "define"), PROBLEM.upper()) == imported()


# --- plans out ----------------------------------------------------------------------------------


def test_ranks_become_epsilons_and_durations_stay_exact() -> None:
    task = example("matchcellar")
    text = plan_text(task, scheduled(task, PLANS["matchcellar"]))
    times = {id: Fraction(t) for t, id, _ in LINE.findall(text)}
    assert {Fraction(lasts) for _, _, lasts in LINE.findall(text)} == {5, 2}
    assert times["(light-match match1)"] < times["(mend-fuse fuse1)"]
    assert times["(mend-fuse fuse1)"] + 2 < times["(mend-fuse fuse2)"]
    assert all(t - round(t) < Fraction(1, 100) for t in times.values())


def test_epsilons_are_small_enough_for_what_lies_close_together() -> None:
    domain = DOMAIN.replace("(len ?x))\n    :cond", "(len ?x))\n    :cond")
    problem = PROBLEM.replace("(= (len b2) 1.25)", "(= (len b2) 0.0001)")
    task = imported(domain, problem)
    plan = "0: (b b1 b2) [0]\n0: (a b2) [0.0001]"
    text = plan_text(task, scheduled(task, plan))
    start, lasts = next((Fraction(t), d) for t, id, d in LINE.findall(text) if id == "(a b2)")
    assert 0 < start < Fraction(1, 10_000)
    assert lasts == "0.0001"


def test_what_is_not_valid_is_not_written() -> None:
    task = example("matchcellar")
    with pytest.raises(PlanError, match="not valid"):
        plan_text(task, Schedule(()))


def test_a_time_that_no_decimal_equals_is_rounded_and_the_plan_says_so() -> None:
    task = imported(DOMAIN.replace("(= ?duration (len ?x))", "(= ?duration (/ (len ?x) 3))"))
    entries = (Entry("(b b1 b2)", 0, 0), Entry("(a b2)", 0, Fraction(5, 12)))
    heading, first, second = plan_text(task, Schedule(entries)).splitlines()
    assert heading.startswith("; times are rounded")
    (lasts,) = re.findall(r"\(a b2\) \[(.*)\]", f"{first} {second}")
    assert 0 < abs(Fraction(lasts) - Fraction(5, 12)) < Fraction(1, 10**6)


@pytest.mark.slow
def test_what_must_come_before_the_start_of_time_is_not_written() -> None:
    """Crossing from 0 to 10 and arriving just before the harbour closes needs a start before 0."""
    domain, problem = (
        (EXAMPLES / "ferry" / f"{part}.pddl").read_text("utf-8") for part in ("domain", "problem")
    )
    domain = domain.replace("(at end (at ?c ?b))", "(at end (at ?c ?b))").replace(
        "(over all (open))", "(at end (open))"
    )
    problem = problem.replace("(at 10 (open))", "(open)").replace("(at 25", "(at 4")
    problem = problem.replace("(ferry-at south)", "(ferry-at north)").replace(
        "(and (at red south) (at blue south))", "(at red south)"
    )
    task = imported(domain, problem)
    schedule = scheduled(task, "0: (carry red north south) [4]")
    assert irc.validate(task, schedule).valid
    with pytest.raises(PlanError, match="no room for any epsilon"):
        plan_text(task, schedule)


# --- bad input ----------------------------------------------------------------------------------


def told(domain: str, problem: str) -> list[Diagnostic]:
    with pytest.raises(InputError) as refused:
        imported(domain, problem)
    found = list(refused.value.report.located())
    assert {d.code for d in found} == {Code.NOT_AN_IMPORT}
    return found


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        (":equality", ":equalty", "there is no requirement ':equalty'", 3),
        ("(at start (p ?x))", "(at start (or (p ?x) (q ?x)))", "takes 0 objects, not 1", 10),
        ("(at start (p ?x))", "(at start (forall (?y - bog) (q)))", "no type 'bog'", 10),
        ("(at start (p ?x))", "(at start (forall (q)))", "expected (forall (", 10),
        ("(at start (p ?x))", "(at start (exists (?y - big) (p ?z)))", "parameter '?z'", 10),
        ("(at start (p ?x))", "(at start (>= (leng ?x) 2))", "no function 'leng'", 10),
        ("(at start (p ?x))", "(at start (>= (len ?x)))", "expected (>= LEFT RIGHT)", 10),
        ("(at start (p ?x))", "(at start (imply (q)))", "expected (imply", 10),
        ("(at start (p ?x))", "(at start (not (q) (r)))", "expected (not CONDITION)", 10),
        ("(at start (p ?x))", "(at start (preference g (q)))", "preferences", 10),
        ("(at start (p ?x))", "(p ?x)", "expected a condition with its time", 10),
        ("(at start (p ?x))", "p", "expected a list in parentheses, not 'p'", 10),
        ("(at end (q))", "(at end (scale-up (len ?x) 1))", "('scale-up')", 11),
        ("(at end (q))", "(increase (len ?x) (* #t 1))", "expected an effect with", 11),
        ("(at end (q))", "(when (over all (p ?x)) (at end (q)))", "over all of the action", 11),
        ("(at end (q))", "(at end (when (r)))", "expected (when CONDITION EFFECT)", 11),
        ("(at end (q))", "(over all (q))", "an effect happens at start or at end", 11),
        ("(at end (q))", "(at end (qq))", "there is no predicate 'qq'", 11),
        ("(at end (q))", "(at end (q ?x))", "the predicate 'q' takes 0 objects, not 1", 11),
        ("(= ?duration (len ?x))", "(at end (= ?duration 1))", "a duration constraint", 9),
        ("(= ?duration (len ?x))", "(< ?duration 1)", "expected (= ?duration", 9),
        ("(:action b", "(:derived (q) (p b1)) (:action b", "the section ':derived'", 12),
        ("(:action b", "(:action a", "there are two actions 'a'", 12),
        (":precondition", ":precondtion", "an action has no ':precondtion'", 14),
        ("?x ?y - big", "?x ?y - (big small)", "(either TYPE …)", 13),
        ("?x ?y - big", "?x y - big", "expected a parameter such as '?x'", 13),
        ("(at end (q))", "(at end (p ?z))", "there is no parameter '?z'", 11),
        ("(at end (q))", "(at end (p b1))", "object 'b1' is of the problem", 11),
        ("(?x - thing)\n", "(?x - thingy)\n", "there is no type 'thingy'", 8),
        ("(domain d)", "(domain)", "expected (define (domain NAME) …)", 1),
        ("(domain d)", "(domain dd)", "this is a problem of 'd', not of 'dd'", 1),
        (":functions", ":functions (", "this '(' is never closed", 1),
        ("(p ?y))))", "(p ?y)))))", "there is no '(' for this ')'", 15),
    ],
)
def test_what_a_domain_has_that_is_not_taken_is_named_with_its_line(
    old: str, new: str, message: str, line: int
) -> None:
    assert old in DOMAIN
    found = told(DOMAIN.replace(old, new, 1), PROBLEM)
    assert any(message in d.message and d.line == line for d in found), found


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("(:goal (q))", "(:goal (preference g (q)))", "preferences", 4),
        ("(:goal (q))", "(:goal (r))", "the goal (r) can never hold", 4),
        ("(:goal (q))", "(:goal (and (q) (not (fixed b2))))", "(not (fixed b2)) can never", 4),
        ("(:goal (q))", "", "the problem has no :goal", 1),
        ("(:goal (q))", "(:goal (q)) (:constraints (always (q)))", "':constraints'", 4),
        ("(:goal (q))", "(:goal (q)) (:metric maximize (total-time))", "longer plans", 4),
        ("(:goal (q))", "(:goal (q)) (:metric minimise (len b1))", "expected (:metric", 4),
        ("(p b1)", "(at 3 (= (len b1) 2))", "timed numeric effects", 3),
        ("(p b1)", "(pp b1)", "there is no predicate 'pp'", 3),
        ("(= (len b2) 1.25)", "(= (len b2) x)", "expected (= (FUNCTION …) NUMBER)", 3),
        ("(= (len b2) 1.25)", "(= (len b2) -1)", "lasts from -1 to -1", None),
        ("(p b1)", "(p b9)", "there is no object 'b9'", 3),
        ("(= (len b2) 1.25)", "(= (length b2) 1.25)", "there is no function 'length'", 3),
        ("(= (len b2) 1.25)", "(= (len b2 b1) 1.25)", "'len' takes 1 objects, not 2", 3),
        ("(= (len b2) 1.25)", "(= (len b7) 1.25)", "there is no object 'b7'", 3),
        ("(p b1)", "(not (pp b1))", "there is no predicate 'pp'", 3),
        ("- big", "- bigg", "there is no type 'bigg'", 2),
        ("(:goal (q))", "(:goal (p ?x))", "there is no parameter '?x'", 4),
        ("(p b1)", "(p b1) 7", "expected a fact in parentheses, not '7'", 3),
    ],
)
def test_what_a_problem_has_that_is_not_taken_is_named_with_its_line(
    old: str, new: str, message: str, line: int | None
) -> None:
    assert old in PROBLEM
    found = told(DOMAIN, PROBLEM.replace(old, new, 1))
    assert any(message in d.message and d.line in (line, None) for d in found), found
    assert line is None or any(d.line == line for d in found)


def test_faults_of_both_files_come_in_one_run() -> None:
    found = told(DOMAIN.replace(":equality", ":adhl"), PROBLEM.replace("(p b1)", "(pp b1)"))
    assert len(found) == 2
    assert any(d.message.startswith("problem.pddl:3:10: ") for d in found)


def test_a_domain_too_large_to_ground_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    # (The package has a function of that name, too.)
    module = import_module("irc.frontends.importers.pddl.ground")
    monkeypatch.setattr(module, "MOST_ACTIONS", 1000)
    names = " ".join(f"x{i}" for i in range(40))
    found = told(DOMAIN, PROBLEM.replace("b1 b2 - big", f"b1 b2 {names} - big"))
    assert "more than 1,000 ground actions" in found[0].message


@pytest.mark.parametrize(
    "text", ["", "(", "(" * 5000, "x", "(define)", "()", "(define (domain d))"]
)
def test_rubbish_is_a_diagnostic(text: str) -> None:
    for files in ((text, PROBLEM), (DOMAIN, text), (text, text)):
        assert told(*files)


@pytest.mark.parametrize("part", [0, 1])
def test_a_file_cut_in_half_is_an_error_with_its_place(part: int) -> None:
    """Wherever it is cut: never a traceback, and never a task of what is left."""
    whole = (DOMAIN, PROBLEM)[part].rstrip()
    for end in range(len(whole)):
        files = [DOMAIN, PROBLEM]
        files[part] = whole[:end]
        with pytest.raises(InputError) as refused:
            imported(*files)
        first = refused.value.report.located().diagnostics[0]
        assert first.code is Code.NOT_AN_IMPORT
        assert first.line is not None or re.search(r"problem\.pddl:\d+:\d+", first.message), end


# --- the command --------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_command_writes_one_task(tmp_path: Path) -> None:
    folder = EXAMPLES / "matchcellar"
    out = tmp_path / "task.json"
    result = run_irc(
        *("convert", folder / "domain.pddl", "--problem", folder / "problem.pddl"),
        *("--from", "pddl", "-o", out),
    )
    assert (result.exit_code, result.stdout) == (0, "")
    assert irc.load(out).ir == example("matchcellar")


def test_the_command_needs_a_problem_and_for_pddl_only(tmp_path: Path) -> None:
    domain = EXAMPLES / "matchcellar" / "domain.pddl"
    result = run_irc("convert", domain, "--from", "pddl", "-o", tmp_path / "x")
    assert (result.exit_code, "--problem FILE" in result.stderr) == (2, True)
    result = run_irc("convert", domain, "--problem", domain, "--from", "robo", "-o", tmp_path / "x")
    assert (result.exit_code, "--problem is for" in result.stderr) == (2, True)
    assert not list(tmp_path.iterdir())


def test_a_refused_domain_is_status_1_and_writes_nothing(tmp_path: Path) -> None:
    domain = tmp_path / "domain.pddl"
    domain.write_text(DOMAIN.replace(":equality", ":derived"))
    problem = tmp_path / "problem.pddl"
    problem.write_text(PROBLEM)
    out = tmp_path / "out.json"
    result = run_irc("convert", domain, "--problem", problem, "--from", "pddl", "-o", out)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "domain.pddl:3:" in result.stderr
    assert "':derived'" in result.stderr
    assert not out.exists()
