"""The judge of plans of PDDL knows the rules of PDDL2.1, one by one."""

from __future__ import annotations

from fractions import Fraction

import pytest

from oracles.pddl_validity import NotJudgedError, reason_against

DOMAIN = """(define (domain lab)
  (:requirements :adl :durative-actions :fluents :timed-initial-literals)
  (:types lamp dish - object)
  (:predicates (on ?l - lamp) (done ?d - dish) (power) (busy))
  (:functions (heat) (rate ?l - lamp) (cost))
  (:durative-action light :parameters (?l - lamp) :duration (= ?duration 5)
    :condition (and (at start (not (on ?l))) (over all (power)))
    :effect (and (at start (on ?l)) (at end (not (on ?l))) (at start (increase (cost) (rate ?l)))))
  (:durative-action cook :parameters (?d - dish) :duration (>= ?duration 2)
    :condition (and (at start (not (busy))) (over all (exists (?l - lamp) (on ?l))))
    :effect (and (at start (busy)) (at end (not (busy))) (at end (done ?d))
                 (at end (increase (heat) ?duration))))
  (:action reset :parameters () :precondition (>= (heat) 4)
    :effect (and (assign (heat) 0)
                 (forall (?d - dish) (when (done ?d) (increase (cost) 10))))))"""

PROBLEM = """(define (problem p) (:domain lab)
  (:objects l1 l2 - lamp soup stew - dish)
  (:init (power) (at 20 (not (power))) (= (heat) 0) (= (cost) 0) (= (rate l1) 1) (= (rate l2) 2))
  (:goal GOAL))"""

ONE = "0: (light l1) [5]\n0.01: (cook soup) [2]\n"
BOTH = f"{ONE}2.02: (cook stew) [2]\n"


@pytest.mark.parametrize(
    ("plan", "goal", "reason"),
    [
        (ONE, "(done soup)", None),
        (BOTH, "(forall (?d - dish) (done ?d))", None),
        (BOTH, "(and (done stew) (= (heat) 4))", None),
        (f"{BOTH}4.5: (reset)\n", "(and (= (heat) 0) (= (cost) 21))", None),
        (f"{ONE}4.5: (reset)\n", "(done soup)", "does not hold"),
        (f"{BOTH}4.02: (reset)\n", "(done soup)", "change the same: ('heat',)"),
        (BOTH.replace("2.02", "2.01"), "(done stew)", "change the same: ('busy',)"),
        (BOTH.replace("2.02", "2"), "(done stew)", "does not hold"),
        (ONE.replace("0.01", "0"), "(done soup)", None),
        (ONE.replace("0.01", "4"), "(done soup)", "does not hold after 5.0"),
        (f"{ONE}4: (light l2) [5]\n4.5: (cook stew) [3]\n", "(done stew)", None),
        (ONE.replace("[2]", "[1]"), "(done soup)", "is false"),
        (ONE.replace("[5]", "[6]"), "(done soup)", "is false"),
        ("16: (light l1) [5]\n", "(power)", "does not hold after 20.0"),
        ("14: (light l1) [5]\n", "(power)", None),
        ("16: (light l1) [5]\n", "(and)", "does not hold after 20.0"),
        (ONE, "(done stew)", "the goal"),
        ("0: (light soup) [5]", "(and)", "cannot be ?l"),
        ("0: (dim l1) [5]", "(and)", "no such action"),
        ("0: (light l1 l2) [5]", "(and)", "takes 1 objects"),
        ("0: (light l1) [5]\n5: (light l1) [5]", "(and)", "change the same: ('on', 'l1')"),
        ("0: (light l1) [5]\n0: (light l2) [5]", "(= (cost) 3)", None),
        ("5: (light l1) [5]\n10.1: (cook soup) [3]\n", "(and)", "does not hold"),
        ("0: (light l1) [5]\n3: (cook soup) [2]\n", "(done soup)", None),
        ("4: (light l1) [5]\n4: (cook soup) [6]\n", "(done soup)", "does not hold after 9.0"),
        ("0: (light l1) [5]\n0.5: (cook soup) [4]\n5: (reset)\n", "(= (heat) 0)", None),
        ("", "(power)", None),
    ],
)
def test_plans_are_judged(plan: str, goal: str, reason: str | None) -> None:
    found = reason_against(DOMAIN, PROBLEM.replace("GOAL", goal), plan)
    assert (found is None) if reason is None else (found is not None and reason in found), found


def test_what_happens_within_epsilon_happens_at_once() -> None:
    problem = PROBLEM.replace("GOAL", "(done stew)")
    assert reason_against(DOMAIN, problem, BOTH, epsilon=Fraction(1, 100)) is None
    found = reason_against(DOMAIN, problem, BOTH, epsilon=Fraction(1, 10))
    assert found is not None
    assert "change the same: ('busy',)" in found


def test_a_fact_that_another_one_makes_true_anyway_may_change() -> None:
    """One lamp goes out at the very time at which cooking asks for any: the other one is enough."""
    domain = DOMAIN.replace("(over all (exists", "(at start (exists")
    plan = "0: (light l1) [5]\n1: (light l2) [5]\n5: (cook soup) [2]\n"
    assert reason_against(domain, PROBLEM.replace("GOAL", "(done soup)"), plan) is None


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(increase (cost) (rate ?l))", "(scale-up (cost) (rate ?l))"),
        ("(:action reset", "(:derived (busy) (power)) (:action reset"),
        ("(at end (increase (heat) ?duration))", "(increase (heat) (* #t 1))"),
    ],
)
def test_what_is_beyond_level_3_is_not_judged(old: str, new: str) -> None:
    assert old in DOMAIN
    with pytest.raises(NotJudgedError):
        reason_against(DOMAIN.replace(old, new), PROBLEM.replace("GOAL", "(and)"), ONE)
