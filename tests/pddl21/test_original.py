"""Planners read the PDDL that a task was made of; what they find is re-timed and judged."""

from __future__ import annotations

import pickle
from dataclasses import replace
from fractions import Fraction

import pytest

import irc
from irc.diagnostics import Code
from irc.driver import beside
from irc.driver.beside import with_planner
from irc.driver.compile import lower_for
from irc.driver.judge import Answer
from irc.driver.solve import solve_task
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan import plan_text
from irc.model import Task
from irc.model.original import OriginalStep
from irc.schedule import Status
from irc.targets import Budget, EngineFailed, Program, SolveOptions, get_backend
from irc_pddl21.planners.kairos import KairosPlanner
from irc_pddl21.search.original import plan_original
from irc_pddl21.search.planner_session import PlannerSession
from oracles.pddl_validity import reason_against
from paths import EXAMPLES


def texts(name: str) -> tuple[str, str]:
    folder = EXAMPLES / "pddl" / name
    domain, problem = (folder / f"{part}.pddl" for part in ("domain", "problem"))
    return domain.read_text("utf-8"), problem.read_text("utf-8")


def example(name: str) -> Task:
    domain, problem = texts(name)
    return import_pddl((domain, "domain.pddl"), (problem, "problem.pddl"))


def test_a_task_knows_its_original_as_long_as_it_is_what_was_read() -> None:
    task = example("deliveries")
    assert task.original is not None
    assert (task.original.domain, task.original.problem) == texts("deliveries")
    assert task.model_copy(update={"deadline": 30}).original is None
    assert task.model_copy().original is not None
    assert pickle.loads(pickle.dumps(task)).original is not None


def test_steps_of_the_original_get_the_ids_of_the_tasks_actions() -> None:
    task = example("matchcellar")
    assert task.original is not None
    step = OriginalStep("(MEND-FUSE fuse1 match1)", Fraction(0), Fraction(2))
    with pytest.raises(irc.InputError, match="no action"):
        task.original.steps_of([step])
    known = OriginalStep("(mend-fuse fuse1)", Fraction(0), Fraction(2))
    assert task.original.steps_of([known]) == [known]


def first_plan(task: Task, seconds: float = 60) -> PlannerSession:
    """A session of kairos that has asked for a plan of the original."""
    backend = get_backend("pddl21")
    program = Program(backend, task, lower_for(task, backend))
    session = PlannerSession(KairosPlanner(), program, SolveOptions(), Budget(seconds))
    plan_original(session)
    return session


@pytest.mark.slow
@pytest.mark.parametrize("name", ["deliveries", "satellite", "ferry", "matchcellar"])
def test_a_plan_of_the_original_is_an_answer_that_says_so(name: str) -> None:
    pytest.importorskip("kairos")
    task = example(name)
    outcome = first_plan(task).outcome()
    assert outcome.schedule is not None
    assert outcome.engine == "kairos, which read the original PDDL"
    assert irc.validate(task, outcome.schedule).valid
    assert reason_against(*texts(name), plan_text(task, outcome.schedule)) is None


def test_a_changed_task_is_not_solved_by_its_original() -> None:
    pytest.importorskip("kairos")
    task = example("matchcellar").model_copy(update={"deadline": 100})
    assert first_plan(task).runs == 0


def answer(makespan: int | None, status: Status = Status.FEASIBLE) -> Answer:
    """An answer with a schedule that ends at a time."""
    task = Task.model_validate({"actions": [{"id": "a", "duration": {"min": 1, "max": 99}}]})
    found = solve_task(task)
    entries = () if makespan is None else (irc.Entry("a", 0, makespan),)
    return replace(found, schedule=replace(found.schedule, entries=entries, status=status))


NOTHING = answer(None, Status.UNKNOWN)


@pytest.mark.parametrize(
    ("usual", "planner", "expected"),
    [
        (answer(5), answer(4), 4),
        (answer(4), answer(5), 4),
        (answer(4), NOTHING, 4),
        (NOTHING, answer(5), 5),
        (NOTHING, NOTHING, None),
        (answer(6, Status.OPTIMAL), answer(4), 6),
    ],
)
def test_the_better_of_two_answers_counts(
    usual: Answer, planner: Answer, expected: int | None
) -> None:
    found = with_planner(lambda _: usual, lambda _: planner, Budget(5), "cpsat")
    entries = found.schedule.entries
    assert (entries[0].end if entries else None) == expected
    is_planners = expected is not None and found.schedule is planner.schedule
    assert any(n.code is Code.NO_ANSWER and "from PDDL" in n.message for n in found.notes) is (
        is_planners
    )


def test_a_planner_that_fails_changes_nothing_and_one_that_answers_saves_the_day() -> None:
    def fails(_: Budget) -> Answer:
        raise EngineFailed("it broke")

    assert with_planner(lambda _: answer(4), fails, Budget(5), "cpsat").schedule.makespan == 4
    assert with_planner(fails, lambda _: answer(5), Budget(5), "cpsat").schedule.makespan == 5
    with pytest.raises(EngineFailed, match="it broke"):
        with_planner(fails, lambda _: NOTHING, Budget(5), "cpsat")
    with pytest.raises(EngineFailed, match="it broke"):
        with_planner(fails, fails, Budget(5), "cpsat")


def test_a_proof_ends_the_planner() -> None:
    ended: list[bool] = []

    def waits(budget: Budget) -> Answer:
        while not budget.is_over:
            pass
        ended.append(budget.is_cancelled)
        return NOTHING

    proven = answer(4, Status.OPTIMAL)
    assert with_planner(lambda _: proven, waits, Budget(60), "cpsat") is proven
    assert ended == [True]


def test_an_answer_that_cannot_be_improved_waits_for_the_planner_for_a_while_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(beside, "LEAST_PATIENCE", 0.05)

    def improves(budget: Budget) -> Answer:
        while not budget.is_over:
            pass
        return answer(3)

    whole = Budget(60)
    found = with_planner(lambda _: answer(4), improves, whole, "cpsat")
    assert found.schedule.makespan == 3
    assert whole.elapsed < 30


class Asked:
    """A session whose planner takes a given time for each kind of search, and finds given plans."""

    def __init__(self, task: Task, plans: dict[str, int], ends: dict[str, float]) -> None:
        backend = get_backend("pddl21")
        self.problem = lower_for(task, backend)
        self.program = Program(backend, task, self.problem)
        self.planner = KairosPlanner()
        self.left = 100.0
        self.best: irc.Schedule | None = None
        self.plans, self.ends = plans, ends
        self.asked: list[str] = []

    def ask(self, _: object, seconds: float, **how: object) -> irc.Schedule | None:
        search = str(how["search"])
        self.asked.append(search)
        needed = self.ends.get(search, 1000.0)
        self.left -= min(seconds, needed)
        if search not in self.plans or needed > seconds:
            return None
        found = irc.Schedule((irc.Entry("a", 0, self.plans[search]),))
        if self.best is None or found.makespan < self.best.makespan:
            self.best = found
        return found


def all_asked(plans: dict[str, int], ends: dict[str, float]) -> Asked:
    session = Asked(example("matchcellar"), plans, ends)
    plan_original(session)  # type: ignore[arg-type]
    return session


SEARCHES = list(KairosPlanner.lifted_searches)


def test_each_kind_of_search_gets_a_little_time_and_then_more() -> None:
    session = all_asked({}, {})
    assert session.asked == 2 * SEARCHES
    assert session.left == pytest.approx(20)


def test_a_search_that_has_ended_without_a_plan_is_not_asked_again() -> None:
    assert all_asked({}, {SEARCHES[0]: 0.1}).asked == [*SEARCHES, *SEARCHES[1:]]


def test_one_kind_of_search_gets_the_time_of_all() -> None:
    ended = dict.fromkeys(SEARCHES[1:], 0.1)
    session = all_asked({SEARCHES[0]: 70}, {**ended, SEARCHES[0]: 59.0})
    assert session.asked == [*SEARCHES, SEARCHES[0]]
    assert session.best is not None


def test_the_best_plan_of_the_first_round_with_one_counts() -> None:
    session = all_asked({SEARCHES[1]: 90, SEARCHES[3]: 80}, dict.fromkeys(SEARCHES, 1.0))
    assert session.asked == SEARCHES
    assert session.best is not None
    assert session.best.makespan == 80


def test_a_plan_at_the_bound_ends_the_round() -> None:
    assert all_asked({SEARCHES[1]: 0}, {SEARCHES[1]: 1.0}).asked == SEARCHES[:2]


def test_a_plan_that_only_the_second_round_has_time_for_is_found() -> None:
    session = all_asked({SEARCHES[2]: 70}, {SEARCHES[2]: 10.0})
    assert session.best is not None
    assert session.asked == 2 * SEARCHES
