"""Measures, statistics and verdicts on small cases made by hand."""

from __future__ import annotations

import itertools
import json
import random
from typing import Any

import pytest

from irc.evaluation.assignment import best_assignment
from irc.evaluation.closure import closure
from irc.evaluation.critical_path import earliest_starts, latest_starts, solved_order_holds
from irc.evaluation.data import kahn_order, step_instance
from irc.evaluation.figure import Rate
from irc.evaluation.graph_rules import planner_scores, scheduled_scores
from irc.evaluation.kitchen import simulate
from irc.evaluation.online import judge_final, read_episode
from irc.evaluation.pddl_meaning import meaning_scores
from irc.evaluation.robo import judge_plan
from irc.evaluation.statistics import interval, mcnemar
from irc.methods import AnswerState, PddlAnswer, read_plan, read_planner, read_schedule_spec

RAW: dict[str, Any] = {
    "answer": 14,
    "question": "Step 1. Mix (2 s)\nStep 2. Heat the oven (9 s)\nStep 3. Bake the cake (5 s)\n",
    "graph": {
        "edges": [[2, 0], [1, 0]],
        "step_to_node": {"1": 1, "2": 2, "3": 0},
        "durations": [5, 2, 9],
    },
}
GOLD = step_instance(RAW, 3, 0)


def written(edges: list[tuple[int, int]], durations: dict[int, float], stated: int = 14) -> str:
    return json.dumps(
        {
            "actions": [{"id": f"step{k}", "duration": d} for k, d in durations.items()],
            "dependencies": [{"before": f"step{a}", "after": f"step{b}"} for a, b in edges],
            "final_answer_seconds": stated,
        }
    )


RIGHT: dict[int, float] = {1: 2, 2: 9, 3: 5}


def test_gold_steps_have_the_durations_and_edges_of_their_nodes() -> None:
    assert GOLD.durations == {1: 2, 2: 9, 3: 5}
    assert GOLD.edges == {(2, 3), (1, 3)}
    assert GOLD.texts == {1: "Mix", 2: "Heat the oven", 3: "Bake the cake"}
    assert kahn_order(3, [(2, 0), (1, 0)]) == [1, 2, 0]


def test_a_right_planner_scores_in_everything() -> None:
    scores = planner_scores(read_planner(written([(2, 3), (1, 3)], RIGHT)), GOLD)
    wrong = ("missing_dep", "incomplete_goal", "wrong_dur", "no_output", "reversed")
    assert {name for name, value in scores.items() if not value} == set(wrong)


def test_a_step_is_known_by_its_number() -> None:
    text = written([(2, 3), (1, 3)], RIGHT).replace("step2", "2")
    assert planner_scores(read_planner(text), GOLD)["plan"]


def test_reversed_edges_keep_the_makespan_and_lose_the_plan() -> None:
    scores = planner_scores(read_planner(written([(3, 2), (3, 1)], RIGHT)), GOLD)
    assert scores["makespan"]
    assert scores["reversed"]
    assert scores["code"]
    assert not scores["plan"]
    assert scores["dep_rec"] == 0


def test_an_edge_too_many_is_let_pass_by_the_size_table_alone() -> None:
    scores = planner_scores(read_planner(written([(2, 3), (1, 3), (1, 2)], RIGHT, 14)), GOLD)
    assert scores["plan_superset"]
    assert not scores["plan"]
    assert scores["dep_prec"] == pytest.approx(2 / 3)


@pytest.mark.parametrize(
    ("durations", "edges", "recorded"),
    [
        ({**RIGHT, 1: 0}, [(2, 3)], 14.0),
        (RIGHT, [(2, 3), (3, 2)], 14.0),
        (RIGHT, [(2, 3)], None),
    ],
)
def test_a_spec_is_rejected(
    durations: dict[int, float], edges: list[tuple[int, int]], recorded: float | None
) -> None:
    answer = read_schedule_spec(written(edges, durations))
    assert scheduled_scores(answer, recorded, GOLD)["invalid"]


def test_a_missing_edge_matters_only_where_the_schedule_breaks_it() -> None:
    durations = {1: 2.0, 2: 9.0, 3: 5.0, 4: 1.0}
    early = earliest_starts(durations, [(2, 3), (3, 4)])
    assert early == {1: 0, 2: 0, 3: 9, 4: 14}
    assert latest_starts(durations, [(2, 3), (3, 4)], 15) == {1: 13, 2: 0, 3: 9, 4: 14}
    bound = frozenset({(2, 3), (3, 4)})
    assert solved_order_holds(durations, bound, [(2, 4)])  # it follows from the others
    assert not solved_order_holds(durations, bound, [(4, 2)])  # no schedule can keep it
    assert not solved_order_holds(durations, frozenset({(2, 3), (3, 2)}), [])
    assert isinstance(solved_order_holds(durations, bound, [(1, 4)]), bool)


def test_the_best_assignment_is_the_best_of_all() -> None:
    draw = random.Random(3)
    for _ in range(40):
        rows, columns = draw.randint(1, 5), draw.randint(1, 5)
        weights = [[draw.randint(0, 4) for _ in range(columns)] for _ in range(rows)]
        found = best_assignment(weights)
        few, many = min(rows, columns), max(rows, columns)
        best = max(
            sum(
                weights[k][chosen[k]] if rows <= columns else weights[chosen[k]][k]
                for k in range(few)
            )
            for chosen in itertools.permutations(range(many), few)
        )
        assert len(set(found.values())) == len(found) == few
        assert sum(weights[row][column] for row, column in found.items()) == best


def test_the_closure_holds_circles_too() -> None:
    assert closure([(1, 2), (2, 3)]) == {(1, 2), (2, 3), (1, 3)}
    assert closure([(1, 2), (2, 1)]) == {(1, 2), (2, 1), (1, 1), (2, 2)}


def test_mcnemar_is_the_two_sided_binomial() -> None:
    assert mcnemar(0, 0) == 1
    assert mcnemar(1, 0) == 1
    assert mcnemar(0, 5) == pytest.approx(2 / 32)
    assert mcnemar(3, 9) == pytest.approx(2 * (1 + 12 + 66 + 220) / 2**12)
    assert mcnemar(600, 0) < 1e-170


def test_an_interval_holds_the_rate_and_is_wider_where_answers_share_an_instance() -> None:
    values = tuple(float(k % 3 == 0) for k in range(60))
    alone = interval(Rate(values, tuple(range(60)), 100))
    rate = Rate(values, tuple(range(60)), 100).value
    assert alone[0] < rate < alone[1]
    assert alone == interval(Rate(values, tuple(range(60)), 100))
    shared = interval(
        Rate(
            tuple(v for v in values[:15] for _ in range(4)),
            tuple(k for k in range(15) for _ in range(4)),
            100,
        )
    )
    assert shared[1] - shared[0] > alone[1] - alone[0]
    assert interval(Rate((1.0, 1.0), (1, 2))) == (1, 1)


# --- PDDL by meaning -----------------------------------------------------------------------------

DOMAIN = """(define (domain cake)
  (:durative-action bake_cake :parameters () :duration (= ?duration 5)
    :condition (and (at start (warm)) (at start (blended))) :effect (at end (done)))
  (:durative-action mix :parameters () :duration (= ?duration 2)
    :condition () :effect (at end (blended)))
  (:durative-action heat_oven :parameters () :duration (= ?duration 9)
    :condition () :effect (at end (warm))))"""
PROBLEM = "(define (problem p) (:init) (:goal (done)))"
PLAN = [[0.0, "heat_oven", 9.0], [0.0, "mix", 2.0], [9.001, "bake_cake", 5.0]]


def meaning(domain: str = DOMAIN, problem: str = PROBLEM, plan: object = PLAN) -> dict[str, float]:
    answer = PddlAnswer(AnswerState.OK, domain, problem)
    return meaning_scores({"outcome": "ok", "plan": plan}, answer, GOLD)


def test_pddl_with_other_names_means_the_gold_graph() -> None:
    assert set(meaning().values()) == {1}


def test_a_fact_that_holds_at_the_start_orders_nothing() -> None:
    scores = meaning(problem="(define (problem p) (:init (warm)) (:goal (done)))")
    assert scores["m_rec"] == 0.5
    assert scores["m_goal"] == pytest.approx(2 / 3)
    assert not scores["m_exact"]


def test_a_plan_that_repeats_a_step_is_wrong() -> None:
    assert not meaning(plan=[*PLAN, [20.0, "mix", 2.0]])["m_plan"]
    assert not meaning(plan=PLAN[1:])["m_plan"]


# --- kitchens ------------------------------------------------------------------------------------

KITCHEN: dict[str, Any] = {
    "id": "k",
    "items": {
        "fish": {"state": "raw", "predicates": ["isfryable"]},
        "leaf": {"state": "raw", "predicates": ["iscuttable"]},
        "plate": {"state": "ready", "predicates": []},
    },
    "goal": {
        "required_states": {"fish": "fried", "leaf": "cut"},
        "stack_order": ["plate", "fish", "leaf"],
    },
    "action_durations": {"fry": 8.0, "cut": 3.0, "stack": 1.0},
    "stations": {"fryer": 1, "cutting_board": 1},
    "temporal_constraints": [
        {
            "before": {"action": "cut", "item": "leaf"},
            "after": {"action": "stack", "item": "leaf"},
            "min_lag": 2,
        }
    ],
    "optimal_makespan": 10.0,
}
BEST = """0.000: (fry fish) [8.000]
0.000: (cut leaf) [3.000]
0.000: (stack plate) [1.000]
8.000: (stack fish) [1.000]
9.000: (stack leaf) [1.000]"""


def test_the_best_plan_of_a_kitchen_is_valid_and_optimal() -> None:
    verdict = judge_plan(KITCHEN, read_plan(BEST))
    assert verdict.valid
    assert verdict.optimal
    later = judge_plan(KITCHEN, read_plan(BEST.replace("9.000: (stack", "9.500: (stack")))
    assert later.valid
    assert not later.optimal


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("(fry fish)", "(fry leaf)", "'leaf' is raw, expected None"),
        ("(fry fish)", "(boil fish)", "station 'boiler' is full (0)"),
        ("(fry fish)", "(smoke fish)", "there is no action 'smoke'"),
        ("(fry fish)", "(fry robot1 fish)", "fry takes 1 arguments, not 2"),
        ("(fry fish)", "(fry bread)", "there is no item 'bread'"),
        ("[8.000]", "[7.000]", "fry lasts 8, not 7"),
        ("8.000: (stack fish)", "7.000: (stack fish)", "at 7: 'fish' is being fried"),
        ("0.000: (stack plate)", "9.500: (stack plate)", "the stack is not in the order"),
        ("0.000: (cut leaf)", "5.000: (cut leaf)", "starts less than 2 after"),
        ("0.000: (cut leaf) [3.000]\n", "", "has no activities"),
    ],
)
def test_the_first_fault_of_a_plan_is_named(old: str, new: str, fault: str) -> None:
    kitchen = {**KITCHEN, "action_durations": {**KITCHEN["action_durations"], "boil": 8.0}}
    assert old in BEST
    found = judge_plan(kitchen, read_plan(BEST.replace(old, new))).fault
    assert found is not None
    assert fault in found


def test_a_station_is_full_and_a_robot_is_busy() -> None:
    two = {**KITCHEN, "items": {**KITCHEN["items"], "cod": KITCHEN["items"]["fish"]}}
    full = simulate(two, read_plan("0: (fry fish) [8]\n7: (fry cod) [8]"))
    assert full.fault == "at 7: station 'fryer' is full (1)"
    assert simulate(two, read_plan("0: (fry fish) [8]\n8: (fry cod) [8]")).fault != full.fault
    staffed = {**KITCHEN, "robots": ["r1"]}
    busy = simulate(staffed, read_plan("0: (fry r1 fish) [8]\n3: (cut r1 leaf) [3]"))
    assert busy.fault == "at 3: robot 'r1' is busy"
    unknown = simulate(staffed, read_plan("0: (fry r2 fish) [8]"))
    assert unknown.fault == "there is no robot 'r2'"


EPISODE: dict[str, Any] = {
    "initial_task": {
        **{k: KITCHEN[k] for k in ("action_durations", "stations")},
        "items": {k: KITCHEN["items"][k] for k in ("fish", "plate")},
        "deliveries": [
            {"id": "first", "required_states": {"fish": "fried"}, "stack_order": ["plate", "fish"]}
        ],
    },
    "events": [
        {
            "trigger_time": 2.5,
            "delta": {
                "add_items": {"leaf": KITCHEN["items"]["leaf"]},
                "add_deliveries": [
                    {
                        "id": "rush_second",
                        "required_states": {"leaf": "cut"},
                        "stack_order": ["leaf"],
                        "deadline": None,
                    }
                ],
            },
        }
    ],
}


def test_a_rush_order_is_due_after_its_work_and_five_seconds() -> None:
    episode = read_episode(EPISODE, None)
    assert [order.deadline for order in episode.orders] == [None, 2.5 + 3 + 1 + 5]
    best = "0: (fry fish) [8]\n0: (stack plate) [1]\n3: (cut leaf) [3]\n"
    early = judge_final(episode, read_plan(best + "6: (stack leaf) [1]\n8: (stack fish) [1]"))
    assert (early.plan, early.strict, early.with_deadlines) == (True, True, True)
    late = judge_final(episode, read_plan(best + "12: (stack leaf) [1]\n8: (stack fish) [1]"))
    assert (late.plan, late.strict, late.with_deadlines) == (True, True, False)
    long = judge_final(episode, read_plan(best + "6: (stack leaf) [2]\n8: (stack fish) [1]"))
    assert (long.plan, long.strict) == (True, False)


def test_deadlines_of_the_data_are_taken_as_they_stand() -> None:
    raw = json.loads(json.dumps(EPISODE))
    raw["events"][0]["delta"]["add_deliveries"][0]["deadline"] = 9
    assert read_episode(raw, None).orders[1].deadline == 9
