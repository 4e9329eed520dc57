"""Interchangeable objects of a PDDL problem: few of their places are left, and no plan is lost."""

from __future__ import annotations

import itertools

import pytest

import irc
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan_reader import read_plan
from irc.model import Task
from irc.schedule import Status

STEP = """(:durative-action step{k} :parameters (?s - step) :duration (= ?duration {d})
    :condition (and (at start (pending ?s)) {needs})
    :effect (and (at start (not (pending ?s))) (at end (done ?s)) (at end (s{k}))))"""


def steps(
    count: int, *, tokens: int | None = None, goal: str = "", more: str = "", token: str = "t"
) -> Task:
    """Steps in a chain, each of which uses up any one of the tokens."""
    actions = [
        STEP.format(k=k, d=k + 1, needs=f"(at start (s{k - 1}))" if k else "") for k in range(count)
    ]
    names = [f"{token}{k}" for k in range(count if tokens is None else tokens)]
    predicates = " ".join(f"(s{k})" for k in range(count))
    domain = f"""(define (domain d) (:types step)
      (:predicates (pending ?s - step) (done ?s - step) {predicates} (other ?s - step))
      {" ".join(actions)} {more})"""
    goal = goal or f"(and (s{count - 1}) {' '.join(f'(done {name})' for name in names)})"
    problem = f"""(define (problem p) (:domain d) (:objects {" ".join(names)} - step)
      (:init {" ".join(f"(pending {name})" for name in names)}) (:goal {goal}))"""
    return import_pddl((domain, "d.pddl"), (problem, "p.pddl"))


def test_each_needed_step_has_the_token_whose_turn_it_is() -> None:
    task = steps(6)
    assert [a.id for a in task.actions] == [f"(step{k} t{k})" for k in range(6)]
    schedule = irc.solve(task, "cpsat", time_limit=20)
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, sum(range(1, 7)))


def test_a_token_more_leaves_each_step_two_places() -> None:
    task = steps(3, tokens=4)
    places = [a.id for a in task.actions]
    assert places == [f"(step{k} t{k + more})" for k, more in itertools.product(range(3), range(2))]


def test_what_is_told_apart_is_not_interchangeable() -> None:
    task = steps(2, goal="(and (s1) (done t0))")
    assert len(task.actions) == 4
    more = """(:durative-action use :parameters (?s - step) :duration (= ?duration 1)
        :condition (at start (done ?s)) :effect (at end (other ?s)))"""
    task = steps(2, goal="(and (s1) (other t0) (other t1))", more=more)
    assert len([a for a in task.actions if "step" in a.id]) == 4


@pytest.mark.parametrize("token", ["t", "step"])
@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_a_plan_with_other_places_is_read_as_one_with_these(
    order: tuple[int, ...], token: str
) -> None:
    """Also where the tokens have the names of actions."""
    plan = "".join(
        f"{start}: (step{k} {token}{number}) [{k + 1}]\n"
        for (k, number), start in zip(enumerate(order), (0, 1.001, 3.002), strict=True)
    )
    task = steps(3, token=token)
    schedule = read_plan(plan, "plan", task)
    assert irc.validate(task, schedule).valid
    assert [e.id for e in schedule.entries] == [f"(step{k} {token}{k})" for k in range(3)]
