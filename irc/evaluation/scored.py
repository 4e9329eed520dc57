"""The recorded answers of a data folder, scored: rows for each method, computed when needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from irc.diagnostics import InputError
from irc.evaluation.data import Data, Record, StepInstance
from irc.evaluation.graph_rules import Scores, graph_scores, numbered, planner_scores
from irc.evaluation.graph_rules import scheduled_scores as scheduled
from irc.evaluation.online import FinalVerdict, judge_final, read_episode
from irc.evaluation.pddl_meaning import OVERFLOW, meaning_scores
from irc.evaluation.pddl_rules import generated_plan_holds, paper_scores, pddl_answer
from irc.evaluation.robo import PDDL_SLACK, SLACK, judge_plan
from irc.evaluation.row import Row, Rows
from irc.methods import (
    Answer,
    AnswerState,
    read_nl_ir,
    read_plan,
    read_plan_answer,
    read_planner,
    read_schedule_spec,
)

Reader = Callable[[str], Answer]
StepKey = tuple[int, int]

FATAL = frozenset({"parse_error", "llm_error", "solver_error", "spec_error"})
"""The errors that end an online run before its last stage."""


@dataclass
class Scored:
    """The rows of every file of recorded answers."""

    data: Data

    # --- AsyncPlan-XXL --------------------------------------------------------------------------

    @cached_property
    def planner(self) -> Rows:
        """The Planner: the model writes graph and makespan."""
        return self._steps("xxl_planner", self._planner)

    @cached_property
    def cpsat(self) -> Rows:
        """The CP-SAT Formalizer."""
        return self._steps("xxl_cpsat", self._scheduled(read_schedule_spec))

    @cached_property
    def direct_cpsat(self) -> Rows:
        """The CP-SAT Formalizer without rewrites."""
        return self._steps("xxl_direct_cpsat", self._scheduled(read_schedule_spec))

    @cached_property
    def nl_cpsat(self) -> Rows:
        """NL IR, compiled to CP-SAT."""
        return self._steps("xxl_nl_cpsat", self._scheduled(read_nl_ir))

    @cached_property
    def nl_ir(self) -> Rows:
        """NL IR, compiled and solved by irc."""
        return self._steps("xxl_nl_cpsat", self._compiled)

    @cached_property
    def pddl(self) -> Rows:
        """The PDDL Formalizer."""
        return self._steps("xxl_pddl", self._pddl(with_meaning=True))

    @cached_property
    def direct_pddl(self) -> Rows:
        """The PDDL Formalizer without rewrites."""
        return self._steps("xxl_direct_pddl", self._pddl(with_meaning=False))

    @cached_property
    def nl_pddl(self) -> Rows:
        """NL IR, compiled to PDDL."""
        return self._steps("xxl_nl_pddl", self._generated)

    @cached_property
    def gold_pddl(self) -> Rows:
        """Gold IR, compiled to PDDL."""
        return self._steps("xxl_gold_pddl", self._generated)

    @cached_property
    def gold_cpsat(self) -> Rows:
        """Gold IR, compiled and solved by irc; the same for every model that has Gold IR runs."""
        solved: dict[StepKey, Scores] = {}

        def score(_: Record, gold: StepInstance) -> _Outcome:
            key = (gold.size, gold.position)
            if key not in solved:
                solved[key] = _gold_scores(gold)
            return _Outcome(solved[key])

        return self._steps("xxl_gold_pddl", score)

    def _steps(self, name: str, score: Callable[[Record, StepInstance], _Outcome]) -> Rows:
        rows = []
        for record in self.data.records(name):
            size, position = record["n"], record["pos"]
            gold = self.data.steps(size, position)
            outcome = score(record, gold)
            rows.append(
                Row(
                    record["model"],
                    str(size),
                    (size, position),
                    outcome.scores,
                    outcome.state,
                    bool(record.get("service_failure")),
                    gold.makespan > OVERFLOW,
                )
            )
        return Rows(tuple(rows))

    @staticmethod
    def _planner(record: Record, gold: StepInstance) -> _Outcome:
        answer = read_planner(record["answer"] or "")
        return _Outcome(planner_scores(answer, gold), answer.state)

    @staticmethod
    def _scheduled(read: Reader) -> Callable[[Record, StepInstance], _Outcome]:
        def score(record: Record, gold: StepInstance) -> _Outcome:
            answer = read(record["answer"] or "")
            return _Outcome(scheduled(answer, record["recorded_makespan"], gold), answer.state)

        return score

    @staticmethod
    def _compiled(record: Record, gold: StepInstance) -> _Outcome:
        answer = read_nl_ir(record["answer"] or "")
        if answer.graph is None or answer.document is None:
            return _Outcome({"read": 0, "makespan": 0, "exact": 0}, answer.state)
        scores = {
            "read": 1,
            "makespan": solved_makespan(answer.document) == gold.makespan,
            "exact": graph_scores(numbered(answer.graph), gold)["exact"],
        }
        return _Outcome(scores, answer.state)

    @staticmethod
    def _pddl(*, with_meaning: bool) -> Callable[[Record, StepInstance], _Outcome]:
        def score(record: Record, gold: StepInstance) -> _Outcome:
            answer = pddl_answer(record)
            scores = paper_scores(record, answer, gold)
            if with_meaning:
                scores |= meaning_scores(record, answer, gold)
            return _Outcome(scores, answer.state)

        return score

    @staticmethod
    def _generated(record: Record, gold: StepInstance) -> _Outcome:
        makespan = record["outcome"] == "ok" and record["plan"] is not None
        plan = makespan and generated_plan_holds(record["plan"], gold)
        return _Outcome({"makespan": makespan, "plan": plan})

    # --- kitchens -------------------------------------------------------------------------------

    @cached_property
    def robo_planner(self) -> Rows:
        """Robo Challenge: plans that models wrote."""
        return self._robo("robo_planner", "answer")

    @cached_property
    def robo_pddl(self) -> Rows:
        """Robo Challenge: plans for model-written PDDL."""
        return self._robo("robo_pddl", "plan")

    @cached_property
    def robo_cpsat(self) -> Rows:
        """Robo Challenge: plans for model-written scheduling JSON."""
        return self._robo("robo_cpsat", "plan")

    def _robo(self, name: str, field: str) -> Rows:
        slack = PDDL_SLACK if name == "robo_pddl" else SLACK
        rows = []
        for record in self.data.records(name):
            kitchen = self.data.instance(self.data.kitchens, record["id"], "robo_challenge")
            answer = read_plan_answer(record[field] or "")
            verdict = judge_plan(kitchen, answer.plan or (), slack)
            scores: Scores = {
                "recorded": record["success"],
                "plan": verdict.valid,
                "optimal": verdict.optimal,
            }
            error = None if verdict.valid else _robo_error(record, answer)
            split = kitchen["split"]
            rows.append(Row(record["model"], split, record["id"], scores, error=error))
        return Rows(tuple(rows))

    @cached_property
    def online_planner(self) -> Rows:
        """Online Robo Challenge: plans that models wrote."""
        return self._online("online_planner")

    @cached_property
    def online_pddl(self) -> Rows:
        """Online Robo Challenge: plans for model-written PDDL."""
        return self._online("online_pddl")

    @cached_property
    def online_cpsat(self) -> Rows:
        """Online Robo Challenge: plans for model-written scheduling JSON."""
        return self._online("online_cpsat")

    def _online(self, name: str) -> Rows:
        rows = []
        for record in self.data.records(name):
            raw = self.data.instance(self.data.episodes, record["id"], "robo_online")
            scores: Scores = {"recorded": record["success"]}
            fatal = record["error_type"] if record["error_type"] in FATAL else None
            plan = read_plan(record["final_plan"] or "", with_waits=True)
            source = self.data.kitchens.get(raw["source_task_id"])
            episode = read_episode(raw, source)
            verdict = FinalVerdict() if fatal else judge_final(episode, plan)
            scores |= {
                "plan": verdict.plan,
                "strict": verdict.strict,
                "with_deadlines": verdict.with_deadlines,
            }
            error = fatal or (None if verdict.plan else "eval_error")
            rows.append(Row(record["model"], raw["difficulty"], record["id"], scores, error=error))
        return Rows(tuple(rows))

    # --- AsyncHow -------------------------------------------------------------------------------

    @cached_property
    def asynchow(self) -> Mapping[str, Rows]:
        """AsyncHow by method."""
        names = ("planner", "pddl", "cpsat")
        return {name: self._asynchow(name) for name in names}

    def _asynchow(self, method: str) -> Rows:
        rows = []
        for record in self.data.records(f"asynchow_{method}"):
            position = record["pos"]
            gold = self.data.instance(self.data.asynchow, position, "asynchow")["gold_seconds"]
            makespan = _asynchow_makespan(method, record, gold)
            rows.append(Row(record["model"], method, position, {"makespan": makespan}))
        return Rows(tuple(rows))


@dataclass(frozen=True)
class _Outcome:
    scores: Scores
    state: AnswerState = AnswerState.OK


def _asynchow_makespan(method: str, record: Record, gold: int) -> bool:
    if method == "pddl":
        return bool(record["outcome"] == "ok")
    if method == "cpsat":
        return bool(record["recorded_makespan"] == gold)
    stated = read_planner(record["answer"] or "").stated_makespan
    return stated is not None and round(stated) == gold


def _robo_error(record: Record, answer: Answer) -> str:
    """The kind of failure that the paper's tables give a run whose plan is not valid."""
    if answer.plan is not None:
        return "eval_error"
    if "domain" in record:
        return "solver_error" if record["domain"] else "llm_error"
    return "llm_error" if "plan" in record else "parse_error"


def solved_makespan(document: Mapping[str, Any]) -> object:
    """The makespan of a task as irc solves it; None where it is refused or has no schedule."""
    from irc.driver.solve import solve_task
    from irc.model import Task

    try:
        return solve_task(Task.model_validate(document)).schedule.makespan
    except (InputError, ValueError):
        return None


def _gold_scores(gold: StepInstance) -> Scores:
    """Whether irc's schedule of the gold graph has the gold makespan, and keeps the gold order."""
    from irc.driver.solve import solve_task
    from irc.model import Task

    document = {
        "irc": "1",
        "actions": [{"id": f"step{k}", "duration": d} for k, d in gold.durations.items()],
        "precedence": [{"before": f"step{a}", "after": f"step{b}"} for a, b in gold.edges],
    }
    schedule = solve_task(Task.model_validate(document)).schedule
    lines = [(entry.start, entry.id, entry.end - entry.start) for entry in schedule.entries]
    makespan = schedule.makespan == gold.makespan
    return {"makespan": makespan, "plan": makespan and generated_plan_holds(lines, gold)}
