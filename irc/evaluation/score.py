"""One's own answers scored: JSON lines of answers against the instances of a benchmark."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from pathlib import Path
from types import NoneType
from typing import Any

from irc.diagnostics import InputError, Report
from irc.driver.solve import solve_task
from irc.evaluation.data import Record, StepInstance, read_instance, unreadable
from irc.evaluation.figure import Count, Table, document, number
from irc.evaluation.graph_rules import (
    Scores,
    numbered,
    own_makespan,
    planner_scores,
    scheduled_scores,
)
from irc.evaluation.grid import WRITERS, Grid, Layout, csv_text, grid_of
from irc.evaluation.kitchen_solving import solved_plan
from irc.evaluation.pddl_meaning import meaning_scores
from irc.evaluation.pddl_rules import pddl_answer
from irc.evaluation.report import interval_of
from irc.evaluation.robo import PDDL_SLACK, SLACK, judge_plan
from irc.evaluation.row import Row, rate
from irc.frontends.json.value import read_line
from irc.methods import (
    Answer,
    AnswerState,
    FinishReason,
    finished,
    read_nl_ir,
    read_plan,
    read_plan_answer,
    read_planner,
    read_schedule_spec,
)
from irc.methods.pddl_answer import read_pddl_task
from irc.model import Task
from irc.model.parts import DurationRange
from irc.model.times import unit_seconds
from irc.schedule import Schedule
from irc.targets import SolveOptions

SOLVE_SECONDS = 10.0
"""The time in which a task of NL IR, or of PDDL without a recorded plan, is solved."""


class ScoredMethod(StrEnum):
    """The methods whose answers `irc eval score` reads."""

    planner = "planner"
    cpsat_formalizer = "cpsat-formalizer"
    nl_ir = "nl-ir"
    pddl21_formalizer = "pddl21-formalizer"


@dataclass(frozen=True)
class Scoring:
    """The scored answers with what was found in each, and the instances without an answer.

    `service_failures` has, by model and id, why a service gave no answer: these are no answers,
    and no measure counts them.
    """

    rows: tuple[Row, ...]
    faults: Mapping[str, str]
    unanswered: tuple[str, ...]
    service_failures: Mapping[tuple[str, str], str] = field(default_factory=dict)

    @property
    def table(self) -> dict[str, Table]:
        """By model: the mean of each measure; and how many answers have which state."""
        models = dict.fromkeys(row.model for row in self.rows)
        by_model = {model: [row for row in self.rows if row.model == model] for model in models}
        return {
            "measures": {
                model: {measure: rate(rows, measure) for measure in rows[0].scores}
                for model, rows in by_model.items()
            },
            "answers": {model: self._states(model, rows) for model, rows in by_model.items()},
        }

    def _states(self, model: str, rows: Sequence[Row]) -> Table:
        counts = {state.value: sum(row.state is state for row in rows) for state in AnswerState}
        if self.service_failures:
            counts["service_failure"] = sum(of == model for of, _ in self.service_failures)
        return {name: Count(number) for name, number in counts.items()}


def score(method: ScoredMethod, instances: Path, answers: Path) -> Scoring:
    """Scores every answer. Raises `InputError` naming what cannot be read or matched."""
    known = dict(_instances(instances))
    rows: list[Row] = []
    faults: dict[str, str] = {}
    failures: dict[tuple[str, str], str] = {}
    for position, record in enumerate(_records(answers), 1):
        key = str(record.get("id"))
        if key not in known:
            raise unreadable(answers, f"line {position}: there is no instance with id {key!r}")
        model = str(record.get("model", "answers"))
        if isinstance(failure := record.get("service_failure"), str):
            failures[model, key] = failure
            continue
        scores, state, report = _scores(method, record, known[key])
        rows.append(Row(model, method, key, scores, state))
        if report.diagnostics:
            faults[f"{model}/{key}"] = report.diagnostics[0].message
    if not rows:
        failed = f", and {len(failures)} service failures" if failures else ""
        raise unreadable(answers, f"there are no answers{failed}")
    answered = {row.instance for row in rows}
    unanswered = tuple(key for key in known if key not in answered)
    return Scoring(tuple(rows), faults, unanswered, failures)


def _instances(path: Path) -> Iterator[tuple[str, StepInstance | Mapping[str, Any]]]:
    """(id, instance) of a file, or of the files of a folder."""
    files = sorted(path.glob("*.json")) if path.is_dir() else [path]
    for file in files:
        try:
            found = read_line(file.read_text("utf-8"))
        except (OSError, ValueError) as error:
            raise unreadable(file, str(error)) from None
        for position, raw in enumerate(found if isinstance(found, list) else [found]):
            if not isinstance(raw, dict) or not {"graph", "items"} & raw.keys():
                raise unreadable(file, "expected AsyncPlan-XXL ('graph') or Robo ('items')")
            yield str(raw.get("id")), _instance(file, raw, position)


def _instance(
    file: Path, raw: Mapping[str, Any], position: int
) -> StepInstance | Mapping[str, Any]:
    if "graph" not in raw:
        return raw
    instance = read_instance(file, raw, 0, position)
    return replace(instance, size=len(instance.durations))


def _records(path: Path) -> Iterator[Record]:
    try:
        data = path.read_bytes()
        text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode("utf-8")
    except (OSError, EOFError, ValueError) as error:
        raise unreadable(path, str(error)) from None
    for position, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        try:
            record = read_line(line)
        except ValueError as error:
            raise unreadable(path, f"line {position}: {error}") from None
        if not isinstance(record, dict) or "id" not in record:
            raise unreadable(path, f"line {position}: expected an object with 'id' and 'answer'")
        if not isinstance(record.get("answer"), (str, NoneType)):
            raise unreadable(path, f"line {position}: 'answer' is not a text")
        yield record


Found = tuple[Scores, AnswerState, Report]


def _scores(
    method: ScoredMethod, record: Record, instance: StepInstance | Mapping[str, Any]
) -> Found:
    if isinstance(instance, StepInstance):
        return _step_scores(method, record, instance)
    return _kitchen_scores(method, record, instance)


def _step_scores(method: ScoredMethod, record: Record, gold: StepInstance) -> Found:
    if method is ScoredMethod.pddl21_formalizer:
        answer = pddl_answer(record)
        recorded = "plan" in record or "outcome" in record
        run = record if recorded else _planned(record.get("answer") or "")
        run = {"outcome": run.get("outcome", "ok"), "plan": run.get("plan")}
        return meaning_scores(run, answer, gold), answer.state, Report()
    read = _finished(_READERS[method](record.get("answer") or ""), record)
    if method is ScoredMethod.planner:
        return _without_totals(planner_scores(read, gold)), read.state, read.report
    if method is ScoredMethod.nl_ir and (task := read.task) is not None:
        read, makespan = _in_seconds(read, task), _solved_seconds(task)
    else:
        makespan = None if read.graph is None else own_makespan(numbered(read.graph))
    scores = scheduled_scores(read, makespan, gold)
    return _without_totals(scores), read.state, read.report


_READERS = {
    ScoredMethod.planner: read_planner,
    ScoredMethod.cpsat_formalizer: read_schedule_spec,
    ScoredMethod.nl_ir: read_nl_ir,
}


def _planned(text: str) -> Record:
    """The run of an answer in PDDL for which no plan is recorded: irc plans it itself."""
    task = read_pddl_task(text).task
    schedule = None if task is None else _schedule(task)
    if schedule is None:
        return {"outcome": "no_plan", "plan": None}
    steps = [(e.start, e.id.strip("()"), e.end - e.start) for e in schedule.entries]
    return {"outcome": "ok", "plan": steps}


def _in_seconds(answer: Answer, task: Task) -> Answer:
    """The answer with the durations of its graph in seconds, the unit of gold durations.

    A task may be in minutes, or have texts such as "1 h". Of a range the least counts.
    """
    unit = unit_seconds(task.time_unit, task.days_per_month)
    seconds: dict[str, int | float] = {}
    for action in task.actions:
        written = action.duration
        least = written.min if isinstance(written, DurationRange) else written
        if least is not None:
            exact = Fraction(task.number(least)) * unit
            seconds[action.id] = int(exact) if exact.denominator == 1 else float(exact)
    if answer.graph is None:
        return answer
    actions = tuple(replace(a, duration=seconds.get(a.id)) for a in answer.graph.actions)
    return replace(answer, graph=replace(answer.graph, actions=actions))


def _solved_seconds(task: Task) -> float | None:
    """The makespan of irc's schedule in seconds; None where there is none within the limit."""
    schedule = _schedule(task)
    unit = unit_seconds(task.time_unit, task.days_per_month)
    return None if schedule is None else float(Fraction(schedule.makespan) * unit)


def _schedule(task: Task) -> Schedule | None:
    """irc's schedule of a task; None where it is refused, or none is found within the limit."""
    try:
        schedule = solve_task(task, SolveOptions(time_limit=SOLVE_SECONDS)).schedule
    except InputError:
        return None
    return schedule if schedule.answered else None


def _finished(answer: Answer, record: Record) -> Answer:
    """The answer in the state that its service's reason gives it, where the record has one."""
    known = [reason for reason in FinishReason if reason == record.get("finish_reason")]
    return finished(answer, known[0]) if known else answer


def _without_totals(scores: Scores) -> Scores:
    """The measures that tell something about one's own answers."""
    left_out = {"no_output", "plan_superset", "plan_valid", "code"}
    return {name: value for name, value in scores.items() if name not in left_out}


def _kitchen_scores(method: ScoredMethod, record: Record, kitchen: Mapping[str, Any]) -> Found:
    text = record.get("answer") or ""
    slack = SLACK
    if method is ScoredMethod.planner:
        answer = read_plan_answer(text)
        plan = answer.plan or ()
    elif method is ScoredMethod.cpsat_formalizer:
        robots = tuple(kitchen.get("robots") or ())
        answer = read_schedule_spec(text, kitchen["stations"], robots)
        plan = solved_plan(text, answer, kitchen)
    elif method is ScoredMethod.pddl21_formalizer:
        plan, slack = read_plan(record.get("plan") or ""), PDDL_SLACK
        answer = Answer(pddl_answer(record).state, text)
    else:
        raise unreadable(Path(str(kitchen["id"])), f"{method} does not answer kitchens")
    verdict = judge_plan(kitchen, plan, slack)
    scores: Scores = {"plan": verdict.valid, "optimal": verdict.optimal}
    return scores, answer.state, answer.report


# --- showing ------------------------------------------------------------------------------------


def written(found: Scoring, layout: Layout) -> str:
    """The scores in a layout; text and JSON name the fault of each answer that has one."""
    if layout is Layout.json:
        return json.dumps(_as_json(found), indent=1)
    if layout is Layout.csv:
        return csv_text(found.table)
    grids = [grid_of(name, table) for name, table in found.table.items()]
    if found.faults:
        grids.append(Grid("faults", ("answer", "fault"), list(found.faults.items())))
    if found.service_failures:
        failures = [(f"{m}/{key}", why) for (m, key), why in found.service_failures.items()]
        grids.append(Grid("service failures", ("answer", "reason"), failures))
    if found.unanswered:
        grids.append(Grid("without an answer", ("instance",), [(k,) for k in found.unanswered]))
    return "\n\n".join(WRITERS[layout](grid) for grid in grids) + "\n"


def _as_json(found: Scoring) -> dict[str, Any]:
    table = found.table
    return {
        "irc_eval": 1,
        "tables": document(table, number),
        "intervals": document(table, interval_of),
        "answers": [
            {
                "model": row.model,
                "id": row.instance,
                "state": row.state.value,
                "scores": {name: float(value) for name, value in row.scores.items()},
            }
            for row in found.rows
        ],
        "faults": dict(found.faults),
        "unanswered": list(found.unanswered),
        "service_failures": {f"{m}/{key}": w for (m, key), w in found.service_failures.items()},
    }
