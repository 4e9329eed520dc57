"""One corrupted answer in each file: exactly the figures that it should change do change."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable

import pytest

from corruption import (
    WORSE_PLANS,
    Lines,
    Path,
    backwards,
    cut,
    differing,
    edges_key,
    few,
    first_half,
    plan_lines,
    plan_text,
    turned_round,
    with_content,
    with_long_last,
    with_long_step,
    without_edge,
    without_last,
)
from irc.evaluation.critical_path import earliest_starts, makespan_of
from irc.evaluation.data import Data, Record
from irc.evaluation.row import Row, Rows
from irc.evaluation.scored import Scored
from paths import SHARED_DATA

pytestmark = [pytest.mark.shared_data, pytest.mark.slow]

SIZE = {"planner": "5", "cpsat": "5", "pddl": "10"}
"""The size of the instances that are left of each method."""


@pytest.fixture(scope="module")
def base() -> Scored:
    return Scored(Data(SHARED_DATA, few))


def perfect(rows: Rows, model: str, holds: Callable[[Row], object]) -> int:
    """The position of the first answer of a model of which something holds."""
    return next(k for k, row in enumerate(rows.rows) if row.model == model and holds(row))


def record_at(base: Scored, file: str, position: int) -> Record:
    return base.data.records(file)[position]


def faith(method: str, *measures: str) -> set[Path]:
    return {("faithfulness_paper", method, measure) for measure in measures}


def errors(method: str, *measures: str) -> set[Path]:
    found = {("errors_paper", method, measure) for measure in measures}
    return found | by_size(method, *measures)


def by_size(method: str, *measures: str) -> set[Path]:
    return {("errors_by_size", method, SIZE[method], measure) for measure in measures}


def plan(method: str, model: str) -> set[Path]:
    return {
        (table, method, model, SIZE[method]) for table in ("xxl_plan_paper", "xxl_plan_meaning")
    }


def delivered(*measures: str) -> set[Path]:
    return {("planner_of_delivered", measure) for measure in measures}


def control(method: str, model: str, measure: int) -> Path:
    return ("ir_control", method, model, "10", str(measure))


def nl_ir(model: str, *columns: int) -> set[Path]:
    return {("nl_ir", model, "10", str(column)) for column in columns}


def graph_of(record: Record) -> tuple[dict[str, float], list[tuple[str, str]]]:
    content = json.loads(record["answer"])
    edges = [(edge["before"], edge["after"]) for edge in content[edges_key(content)]]
    return {action["id"]: action["duration"] for action in content["actions"]}, edges


def own_makespan(durations: dict[str, float], edges: Iterable[tuple[str, str]]) -> float:
    number = {name: k for k, name in enumerate(durations)}
    times = {number[name]: duration for name, duration in durations.items()}
    starts = earliest_starts(times, [(number[a], number[b]) for a, b in edges])
    assert starts is not None
    return makespan_of(times, starts)


def edge_at(record: Record, *, critical: bool) -> int:
    """The position of an edge without which the graph is shorter (or is not)."""
    durations, edges = graph_of(record)
    whole = own_makespan(durations, edges)
    shorter = (
        own_makespan(durations, [*edges[:k], *edges[k + 1 :]]) < whole for k in range(len(edges))
    )
    return next(k for k, is_shorter in enumerate(shorter) if is_shorter is critical)


def critical_step(record: Record) -> int:
    """The position of the step that the last critical edge leads to."""
    durations, edges = graph_of(record)
    after = edges[edge_at(record, critical=True)][1]
    return list(durations).index(after)


# --- graphs --------------------------------------------------------------------------------------


def planner_record(base: Scored) -> tuple[int, Record]:
    position = perfect(base.planner, "qwen", lambda row: row.scores["plan"])
    return position, record_at(base, "xxl_planner", position)


def test_a_dropped_edge_of_a_planner_changes_recall_and_plan(base: Scored) -> None:
    position, record = planner_record(base)
    worse = without_edge(record, edge_at(record, critical=False))
    expected = plan("planner", "qwen") | faith("planner", "plan", "dep_rec")
    expected |= by_size("planner", "dep_rec") | errors("planner", "missing_dep")
    expected |= delivered("plan_superset", "dep_rec")
    assert differing(base, "xxl_planner", position, worse) == expected


def test_a_long_step_of_a_planner_changes_durations_and_plan(base: Scored) -> None:
    position, record = planner_record(base)
    worse = with_long_step(record, critical_step(record))
    expected = plan("planner", "qwen") | faith("planner", "plan", "dur")
    expected |= errors("planner", "wrong_dur") | delivered("plan_superset", "dur", "code")
    assert differing(base, "xxl_planner", position, worse) == expected


def test_reversed_edges_of_a_planner_leave_the_makespan_as_it_is(base: Scored) -> None:
    position, record = planner_record(base)
    expected = plan("planner", "qwen") | faith("planner", "plan", "dep_rec", "dep_prec")
    expected |= by_size("planner", "dep_rec") | errors("planner", "missing_dep")
    expected |= delivered("plan_superset", "dep_rec") | {("reversed_edges", "planner", "qwen")}
    assert differing(base, "xxl_planner", position, turned_round(record)) == expected


def test_a_cut_answer_of_a_planner_is_no_answer(base: Scored) -> None:
    position, record = planner_record(base)
    every = ("makespan", "dep_prec", "dep_rec", "goal", "count", "dur", "plan")
    expected = plan("planner", "qwen") | faith("planner", *every)
    expected |= errors("planner", "missing_dep", "incomplete_goal", "wrong_dur", "no_output")
    expected |= by_size("planner", "dep_rec", "makespan")
    expected |= {("xxl_makespan", "planner", "qwen", "5")}
    expected |= {("planner_answers", "qwen", state) for state in ("ok", "truncated")}
    of_delivered = delivered("makespan", "plan_superset", "code", "dep_rec", "dur")
    found = differing(base, "xxl_planner", position, cut(record))
    assert expected <= found
    assert found - expected <= of_delivered  # a mean of which one right answer is left out


def cpsat_record(base: Scored) -> tuple[int, Record]:
    position = perfect(base.cpsat, "qwen", lambda row: row.scores["plan"])
    return position, record_at(base, "xxl_cpsat", position)


CPSAT_PLAN = plan("cpsat", "qwen") | faith("cpsat", "plan_valid")


def test_a_dropped_edge_of_a_spec_changes_recall_and_plan(base: Scored) -> None:
    position, record = cpsat_record(base)
    worse = without_edge(record, edge_at(record, critical=True))
    expected = CPSAT_PLAN | faith("cpsat", "dep_rec") | by_size("cpsat", "dep_rec")
    expected |= errors("cpsat", "missing_dep")
    assert differing(base, "xxl_cpsat", position, worse) == expected


def test_a_long_step_of_a_spec_changes_durations_and_plan(base: Scored) -> None:
    position, record = cpsat_record(base)
    worse = with_long_step(record, critical_step(record))
    expected = CPSAT_PLAN | faith("cpsat", "dur") | errors("cpsat", "wrong_dur")
    assert differing(base, "xxl_cpsat", position, worse) == expected


def test_reversed_edges_of_a_spec_are_counted(base: Scored) -> None:
    position, record = cpsat_record(base)
    expected = CPSAT_PLAN | faith("cpsat", "dep_rec", "dep_prec") | by_size("cpsat", "dep_rec")
    expected |= errors("cpsat", "missing_dep") | {("reversed_edges", "cpsat", "qwen")}
    assert differing(base, "xxl_cpsat", position, turned_round(record)) == expected


def test_a_cut_spec_is_rejected_and_its_recorded_makespan_stays(base: Scored) -> None:
    position, record = cpsat_record(base)
    expected = CPSAT_PLAN | faith("cpsat", "dep_prec", "dep_rec", "goal", "count", "dur")
    expected |= by_size("cpsat", "dep_rec")
    expected |= errors("cpsat", "missing_dep", "incomplete_goal", "wrong_dur", "invalid")
    assert differing(base, "xxl_cpsat", position, cut(record)) == expected


@pytest.mark.parametrize(
    ("file", "method"), [("xxl_direct_cpsat", "direct-cpsat"), ("xxl_nl_cpsat", "nl-cpsat")]
)
def test_the_control_changes_in_plan_alone(base: Scored, file: str, method: str) -> None:
    rows = base.direct_cpsat if method == "direct-cpsat" else base.nl_cpsat
    position = perfect(rows, "qwen", lambda row: row.scores["plan"])
    record = record_at(base, file, position)
    is_ir = method == "nl-cpsat"
    changed = {control(method, "qwen", 1)}
    for worse, also in (
        (without_edge(record, edge_at(record, critical=True)), nl_ir("qwen", 2, 3)),
        (with_long_step(record, critical_step(record)), nl_ir("qwen", 2, 3)),
        (turned_round(record), nl_ir("qwen", 3)),
        (cut(record), nl_ir("qwen", 1, 2, 3)),
    ):
        expected = changed | (also if is_ir else set())
        if worse["answer"] == turned_round(record)["answer"]:
            expected |= {("reversed_edges", method, "qwen")}
        assert differing(base, file, position, worse) == expected


# --- PDDL ----------------------------------------------------------------------------------------


def pddl_record(base: Scored) -> tuple[int, Record]:
    every = ("plan", "m_plan", "m_exact", "m_dur_all", "m_goal_all", "dep_rec", "dep_prec")
    position = perfect(
        base.pddl, "gpt", lambda row: all(row.scores[measure] == 1 for measure in every)
    )
    return position, record_at(base, "xxl_pddl", position)


def with_domain(record: Record, change: Callable[[str], str]) -> Record:
    def replace(content: dict[str, list[dict[str, str]]]) -> None:
        response = content["responses"][0]
        response["domain_pddl"] = change(response["domain_pddl"])

    return with_content({**record, "answer": _inner(record["answer"])}, replace)


def _inner(text: str) -> str:
    return text[text.find("{") : text.rfind("}") + 1]


def meaning(*measures: str) -> set[Path]:
    return {
        ("faithfulness_meaning_pddl", whose, measure)
        for whose in ("gpt", "all")
        for measure in measures
    }


FAITHFUL = {("pddl_meaning", "faithful")}
DONE = re.compile(r"\(at start \((\w+_done)\)\)")


def test_a_dropped_condition_changes_recall(base: Scored) -> None:
    position, record = pddl_record(base)
    worse = with_domain(record, lambda domain: DONE.sub("", domain, count=1))
    expected = faith("pddl", "dep_rec") | by_size("pddl", "dep_rec") | FAITHFUL
    expected |= errors("pddl", "missing_dep") | meaning("m_rec", "m_exact")
    assert differing(base, "xxl_pddl", position, worse) == expected


def test_a_long_action_changes_durations(base: Scored) -> None:
    position, record = pddl_record(base)

    def stretch(domain: str) -> str:
        return re.sub(r"\?duration (\d+)", lambda m: f"?duration {int(m[1]) * 24}", domain, count=1)

    expected = faith("pddl", "dur") | errors("pddl", "wrong_dur") | FAITHFUL
    expected |= meaning("m_dur", "m_dur_all")
    assert differing(base, "xxl_pddl", position, with_domain(record, stretch)) == expected


def test_reversed_conditions_change_order_alone(base: Scored) -> None:
    position, record = pddl_record(base)
    expected = faith("pddl", "dep_rec", "dep_prec") | by_size("pddl", "dep_rec") | FAITHFUL
    expected |= errors("pddl", "missing_dep") | meaning("m_rec", "m_prec", "m_exact")
    assert differing(base, "xxl_pddl", position, with_domain(record, reversed_order)) == expected


def reversed_order(domain: str) -> str:
    """The domain with the conditions of each action made of those that waited for it."""
    head, *actions = re.split(r"(?=\(:durative-action)", domain)
    made = [re.findall(r"at end \((\w+_done)\)", a)[-1] for a in actions]
    needed = [set(DONE.findall(a)) for a in actions]
    turned = []
    for k, action in enumerate(actions):
        waiting = [made[j] for j, names in enumerate(needed) if made[k] in names]
        conditions = " ".join(f"(at start ({name}))" for name in waiting)
        plain = DONE.sub("", action)
        turned.append(re.sub(r":effect", f":condition (and {conditions}) :effect", plain, count=1))
    return "".join([head, *turned])


def test_a_cut_answer_with_pddl_keeps_only_what_is_recorded(base: Scored) -> None:
    position, record = pddl_record(base)
    found = differing(base, "xxl_pddl", position, cut(record))
    every = ("read", "prec", "rec", "goal", "count", "dur", "plan", "exact", "dur_all", "goal_all")
    expected = meaning(*(f"m_{name}" for name in every)) | FAITHFUL | plan("pddl", "gpt")
    expected |= faith("pddl", "dep_prec", "dep_rec", "goal", "count", "dur", "plan")
    expected |= by_size("pddl", "dep_rec") | {("pddl_meaning", "plan_no_overflow", "0")}
    kinds = ("missing_dep", "incomplete_goal", "effect_mismatch", "wrong_dur")
    was_wrong = {kind for kind in kinds if base.pddl.rows[position].scores[kind]}
    expected |= errors("pddl", *(kind for kind in kinds if kind not in was_wrong))
    if not base.pddl.rows[position].scores["goal"]:
        expected -= faith("pddl", "goal")
    assert found == expected


def test_the_figures_of_direct_pddl_hang_on_the_recorded_plan(base: Scored) -> None:
    position = perfect(base.direct_pddl, "gemini", lambda row: row.scores["makespan"])
    record = record_at(base, "xxl_direct_pddl", position)
    assert differing(base, "xxl_direct_pddl", position, cut(record)) == set()
    without = {**record, "plan": None, "outcome": "no_plan"}
    expected = {control("direct-pddl", "gemini", 0)}
    assert differing(base, "xxl_direct_pddl", position, without) == expected


@pytest.mark.parametrize("worsen", WORSE_PLANS)
@pytest.mark.parametrize(
    ("file", "method"), [("xxl_nl_pddl", "nl-pddl"), ("xxl_gold_pddl", "gold-pddl")]
)
def test_a_worse_plan_of_compiled_pddl_changes_the_plan_alone(
    base: Scored, file: str, method: str, worsen: Callable[[Lines], Lines]
) -> None:
    rows = base.nl_pddl if method == "nl-pddl" else base.gold_pddl
    position = perfect(rows, "gpt", lambda row: row.scores["plan"])
    record = record_at(base, file, position)
    lines = [(start, name, duration) for start, name, duration in record["plan"]]
    expected = {control(method, "gpt", 1)}
    if method == "gold-pddl":
        expected |= {("gold_pddl", "plan"), ("gold_pddl", "clean_plan")}
    worse = {**record, "plan": worsen(lines)}
    assert differing(base, file, position, worse) == expected


# --- kitchens ------------------------------------------------------------------------------------


@pytest.mark.parametrize("worsen", WORSE_PLANS)
@pytest.mark.parametrize(
    ("file", "field", "method", "failed"),
    [
        ("robo_planner", "answer", "planner", "eval_error"),
        ("robo_pddl", "plan", "formalizer", "eval_error"),
        ("robo_cpsat", "plan", "cpsat_formalizer", "eval_error"),
    ],
)
def test_a_worse_plan_of_a_kitchen_changes_plan_and_optimum(
    base: Scored,
    file: str,
    field: str,
    method: str,
    failed: str,
    worsen: Callable[[Lines], Lines],
) -> None:
    rows: Rows = getattr(base, file)
    position = perfect(rows, "gpt", lambda row: row.scores["optimal"])
    record = record_at(base, file, position)
    worse = {**record, field: plan_text(worsen(plan_lines(record[field])))}
    expected = {("robo", method, "easy", m) for m in ("plan", "optimal")}
    expected |= {("robo_by_model", method, "gpt", m) for m in ("plan", "optimal")}
    expected |= {("robo_errors", method, kind) for kind in ("ok", failed)}
    assert differing(base, file, position, worse) == expected


def online_paths(method: str, model: str, *measures: str) -> set[Path]:
    found = {("online_by_model", method, model, m) for m in measures}
    if method != "cpsat_formalizer":
        found |= {("online", method, "online_easy", m) for m in measures}
    return found


@pytest.mark.parametrize(
    ("file", "method", "model"),
    [("online_planner", "planner", "gpt"), ("online_cpsat", "cpsat_formalizer", "deepseek")],
)
def test_a_worse_final_plan_changes_all_verdicts_on_it(
    base: Scored, file: str, method: str, model: str
) -> None:
    rows: Rows = getattr(base, file)
    position = perfect(rows, model, lambda row: row.scores["with_deadlines"])
    record = record_at(base, file, position)
    lines = plan_lines(record["final_plan"])
    every = online_paths(method, model, "plan", "strict", "with_deadlines")
    every |= {("online_errors", method, kind) for kind in ("ok", "eval_error")}
    for worsen in (without_last, backwards, first_half):
        worse = {**record, "final_plan": plan_text(worsen(lines))}
        assert differing(base, file, position, worse) == every
    long = {**record, "final_plan": plan_text(with_long_last(lines))}
    expected = online_paths(method, model, "strict", "with_deadlines")
    assert differing(base, file, position, long) == expected


def test_a_worse_final_plan_of_model_written_pddl_changes_the_verdicts_that_it_had(
    base: Scored,
) -> None:
    rows = base.online_pddl
    position = perfect(rows, "gemini", lambda row: row.scores["plan"])
    had = [m for m in ("plan", "strict", "with_deadlines") if rows.rows[position].scores[m]]
    record = record_at(base, "online_pddl", position)
    lines = plan_lines(record["final_plan"])
    expected = {("online_by_model", "formalizer", "gemini", m) for m in had}
    expected |= {("online", "formalizer", "online_hard_temporal", m) for m in had}
    expected |= {("online_errors", "formalizer", kind) for kind in ("ok", "eval_error")}
    for worsen in (without_last, backwards, first_half):
        worse = {**record, "final_plan": plan_text(worsen(lines))}
        assert differing(base, "online_pddl", position, worse) == expected
    long = {**record, "final_plan": plan_text(with_long_last(lines))}
    stricter = {path for path in expected if path[-1] in ("strict", "with_deadlines")}
    assert differing(base, "online_pddl", position, long) == stricter


def test_a_failed_online_run_stays_failed_whatever_its_plan(base: Scored) -> None:
    record = record_at(base, "online_pddl", 0)
    assert record["success"] is False
    worse = {**record, "final_plan": cut(record, "final_plan")["final_plan"]}
    assert differing(base, "online_pddl", 0, worse) == set()


# --- AsyncHow ------------------------------------------------------------------------------------


def test_asynchow_goes_by_the_stated_makespan_alone(base: Scored) -> None:
    rows = base.asynchow["planner"]
    position = perfect(rows, "qwen", lambda row: row.scores["makespan"])
    record = record_at(base, "asynchow_planner", position)
    assert differing(base, "asynchow_planner", position, turned_round(record)) == set()
    assert differing(base, "asynchow_planner", position, with_long_step(record, 0)) == set()
    expected = {("asynchow", "planner", "qwen")}
    assert differing(base, "asynchow_planner", position, cut(record)) == expected


def test_asynchow_on_cpsat_goes_by_the_recorded_makespan_alone(base: Scored) -> None:
    rows = base.asynchow["cpsat"]
    position = perfect(rows, "qwen", lambda row: row.scores["makespan"])
    record = record_at(base, "asynchow_cpsat", position)
    for worse in (cut(record), turned_round(record), with_long_step(record, 0)):
        assert differing(base, "asynchow_cpsat", position, worse) == set()


def test_asynchow_on_pddl_goes_by_the_recorded_outcome_alone(base: Scored) -> None:
    rows = base.asynchow["pddl"]
    position = perfect(rows, "qwen", lambda row: row.scores["makespan"])
    record = record_at(base, "asynchow_pddl", position)
    lines = [(start, name, duration) for start, name, duration in record["plan"]]
    domain = record["domain"]
    for worse in (
        {**record, "domain": re.sub(r"\(at start \(\w+\)\)", "", domain, count=1)},
        {**record, "domain": re.sub(r"\(= \?duration ", r"\g<0>24", domain, count=1)},
        {**record, "domain": domain.replace("at start", "AT").replace("at end", "at start")},
        {**record, "plan": backwards(lines)},
        {**record, "plan": with_long_last(lines)},
        cut(record, "domain"),
        cut(record, "problem"),
    ):
        assert worse != record
        assert differing(base, "asynchow_pddl", position, worse) == set()
    for outcome in ("wrong_makespan", "no_plan"):
        worse = {**record, "outcome": outcome, "plan": None}
        assert differing(base, "asynchow_pddl", position, worse) == {("asynchow", "pddl", "qwen")}
