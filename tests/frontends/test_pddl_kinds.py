"""Small instances of each kind of temporal domain: read, solved, and judged on the original PDDL.

The kinds are those of the planning competitions; the instances are our own, with known optima.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import pytest

import irc
from irc.frontends.importers.pddl import import_pddl
from irc.frontends.importers.pddl.plan import plan_text
from irc.schedule import Status
from oracles.pddl_validity import reason_against


class Kind(NamedTuple):
    """A domain and a problem, and the least makespan."""

    domain: str
    problem: str
    makespan: Fraction


def kind(domain: str, problem: str, makespan: float) -> Kind:
    return Kind(
        f"(define (domain d) {domain})",
        f"(define (problem p) (:domain d) {problem})",
        Fraction(str(makespan)),
    )


KINDS = {
    # A plane refuels: the duration depends on what is left in the tank.
    "planes": kind(
        """(:types plane city - object) (:predicates (at ?p - plane ?c - city))
        (:functions (fuel ?p - plane) (size ?p - plane) (far ?a ?b - city))
        (:durative-action fly :parameters (?p - plane ?a ?b - city)
          :duration (= ?duration (/ (far ?a ?b) 2))
          :condition (and (at start (at ?p ?a)) (at start (>= (fuel ?p) (far ?a ?b))))
          :effect (and (at start (not (at ?p ?a))) (at end (at ?p ?b))
                       (at end (decrease (fuel ?p) (far ?a ?b)))))
        (:durative-action refuel :parameters (?p - plane ?c - city)
          :duration (= ?duration (/ (- (size ?p) (fuel ?p)) 4))
          :condition (and (at start (> (size ?p) (fuel ?p))) (over all (at ?p ?c)))
          :effect (at end (assign (fuel ?p) (size ?p))))""",
        """(:objects jet - plane a b - city)
        (:init (at jet a) (= (fuel jet) 2) (= (size jet) 8) (= (far a b) 6)) (:goal (at jet b))""",
        1.5 + 3,
    ),
    # Orders take a place each; one more place is opened only where all are taken.
    "stacks": kind(
        """(:types order - object) (:predicates (waiting ?o - order) (begun ?o - order))
        (:functions (taken) (places))
        (:durative-action take :parameters (?o - order) :duration (= ?duration 1)
          :condition (and (at start (waiting ?o)) (at start (< (taken) (places))))
          :effect (and (at start (not (waiting ?o))) (at end (begun ?o))
                       (at start (increase (taken) 1))))
        (:durative-action open-and-take :parameters (?o - order) :duration (= ?duration 5)
          :condition (and (at start (waiting ?o)) (at start (>= (taken) (places))))
          :effect (and (at start (not (waiting ?o))) (at end (begun ?o))
                       (at start (increase (taken) 1)) (at start (increase (places) 1))))""",
        """(:objects o1 o2 - order) (:init (waiting o1) (waiting o2) (= (taken) 0) (= (places) 1))
        (:goal (and (begun o1) (begun o2)))""",
        5,
    ),
    # What is bought is what is on sale; it is loaded for as long as there is of it.
    "market": kind(
        """(:predicates (open)) (:functions (on-sale) (ready) (loaded))
        (:durative-action buy-all :parameters () :duration (= ?duration 1)
          :condition (and (at start (> (on-sale) 0)) (over all (open)))
          :effect (and (at start (increase (ready) (on-sale))) (at start (assign (on-sale) 0))))
        (:durative-action load :parameters () :duration (= ?duration (* 1.5 (ready)))
          :condition (at start (> (ready) 0))
          :effect (and (at start (increase (loaded) (ready))) (at start (assign (ready) 0))))""",
        """(:init (open) (= (on-sale) 4) (= (ready) 0) (= (loaded) 0)) (:goal (>= (loaded) 4))""",
        6,
    ),
    # A window of time, by timed literals, and a number that must suffice.
    "window": kind(
        """(:predicates (seen) (done)) (:functions (power))
        (:durative-action look :parameters () :duration (= ?duration 4)
          :condition (and (over all (seen)) (at start (>= (power) 3)))
          :effect (and (at start (decrease (power) 3)) (at end (done))))""",
        """(:init (= (power) 3) (at 5 (seen)) (at 10 (not (seen)))) (:goal (done))""",
        9,
    ),
    # A fuse is mended while a match gives light (concurrency that is required).
    "matches": kind(
        """(:types match fuse - object) (:predicates (light) (unused ?m - match) (mended ?f - fuse))
        (:durative-action strike :parameters (?m - match) :duration (= ?duration 3)
          :condition (at start (unused ?m))
          :effect (and (at start (not (unused ?m))) (at start (light)) (at end (not (light)))))
        (:durative-action mend :parameters (?f - fuse) :duration (= ?duration 2)
          :condition (over all (light)) :effect (at end (mended ?f)))""",
        """(:objects m1 - match f1 f2 - fuse) (:init (unused m1))
        (:goal (and (mended f1) (mended f2)))""",
        3,
    ),
    # Segments block each other: ADL with quantifiers, implication and conditional effects.
    "runway": kind(
        """(:requirements :adl :durative-actions) (:types plane segment - object)
        (:predicates (on ?p - plane ?s - segment) (next ?s ?t - segment) (near ?s ?t - segment)
          (gone ?p - plane) (exit ?s - segment))
        (:durative-action move :parameters (?p - plane ?s ?t - segment) :duration (= ?duration 2)
          :condition (and (at start (on ?p ?s)) (at start (next ?s ?t))
            (at start (forall (?q - plane) (not (on ?q ?t))))
            (at start (forall (?q - plane ?u - segment)
               (imply (and (on ?q ?u) (near ?t ?u)) (= ?q ?p)))))
          :effect (and (at start (not (on ?p ?s))) (at start (on ?p ?t))
            (at end (when (exit ?t) (gone ?p)))))
        (:durative-action leave :parameters (?p - plane ?s - segment) :duration (= ?duration 1)
          :condition (and (at start (on ?p ?s)) (at start (gone ?p)))
          :effect (at start (not (on ?p ?s))))""",
        """(:objects p1 p2 - plane s1 s2 s3 - segment)
        (:init (on p1 s2) (on p2 s1) (next s1 s2) (next s2 s3) (near s3 s2) (near s2 s3) (exit s3))
        (:goal (and (gone p1) (gone p2)))""",
        2 + 2,
    ),
    # Hoists stand where they stand: static facts are joined.
    "hoists": kind(
        """(:types place crate hoist truck - object)
        (:predicates (of ?h - hoist ?p - place) (at ?c - crate ?p - place)
          (in ?c - crate ?t - truck) (free ?h - hoist) (truck-at ?t - truck ?p - place))
        (:functions (far ?a ?b - place))
        (:durative-action drive :parameters (?t - truck ?a ?b - place)
          :duration (= ?duration (far ?a ?b)) :condition (at start (truck-at ?t ?a))
          :effect (and (at start (not (truck-at ?t ?a))) (at end (truck-at ?t ?b))))
        (:durative-action load :parameters (?h - hoist ?c - crate ?t - truck ?p - place)
          :duration (= ?duration 1)
          :condition (and (over all (of ?h ?p)) (at start (at ?c ?p)) (over all (truck-at ?t ?p))
            (at start (free ?h)))
          :effect (and (at start (not (at ?c ?p))) (at start (not (free ?h))) (at end (free ?h))
            (at end (in ?c ?t))))
        (:durative-action unload :parameters (?h - hoist ?c - crate ?t - truck ?p - place)
          :duration (= ?duration 1)
          :condition (and (over all (of ?h ?p)) (at start (in ?c ?t)) (over all (truck-at ?t ?p))
            (at start (free ?h)))
          :effect (and (at start (not (in ?c ?t))) (at start (not (free ?h))) (at end (free ?h))
            (at end (at ?c ?p))))""",
        """(:objects a b - place c1 - crate h1 h2 - hoist t1 - truck)
        (:init (of h1 a) (of h2 b) (free h1) (free h2) (at c1 a) (truck-at t1 a) (= (far a b) 3.5)
               (= (far b a) 3.5) (= (far a a) 0) (= (far b b) 0))
        (:goal (at c1 b))""",
        5.5,
    ),
    # A share of one processor for each call, and a duration within limits.
    "calls": kind(
        """(:types call - object) (:predicates (served ?c - call) (open ?c - call))
        (:functions (used) (share ?c - call))
        (:durative-action serve :parameters (?c - call)
          :duration (and (>= ?duration 2) (<= ?duration 4))
          :condition (and (at start (open ?c)) (at start (<= (+ (used) (share ?c)) 10)))
          :effect (and (at start (not (open ?c))) (at start (increase (used) (share ?c)))
            (at end (decrease (used) (share ?c))) (at end (served ?c))))""",
        """(:objects c1 c2 - call)
        (:init (open c1) (open c2) (= (used) 0) (= (share c1) 6) (= (share c2) 5))
        (:goal (and (served c1) (served c2)))""",
        2 + 2,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_each_kind_is_solved_and_its_plan_is_valid_on_the_original(name: str) -> None:
    domain, problem, makespan = KINDS[name]
    task = import_pddl((domain, "domain.pddl"), (problem, "problem.pddl"))
    schedule = irc.solve(task, time_limit=20)
    assert schedule.status in (Status.OPTIMAL, Status.FEASIBLE)
    assert schedule.makespan == makespan
    plan = plan_text(task, schedule)
    assert reason_against(domain, problem, plan) is None, plan


def test_numbers_that_grow_are_bounded_by_how_often_they_can() -> None:
    """Each order is taken once, so there are at most three places, and two of them are taken."""
    domain, problem, _ = KINDS["stacks"]
    task = import_pddl((domain, "domain.pddl"), (problem, "problem.pddl"))
    known = {v.id for v in task.state if v.id.startswith("(= (places)")}
    assert known <= {f"(= (places) {k})" for k in (1, 2, 3)}
    again = domain.replace("(at end (begun ?o))", "(at end (begun ?o)) (at end (waiting ?o))")
    with pytest.raises(irc.InputError, match="may have more than 200 values"):
        import_pddl((again, "domain.pddl"), (problem, "problem.pddl"))
