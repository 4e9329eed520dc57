"""Results: how one trial of a batch ended, and the JSON line that records it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from irc.batches.trial import Pairing, Trial, TrialKey, trial_key
from irc.diagnostics import InputError, Report
from irc.model.times import json_number, parse_number
from irc.outcome import INFEASIBLE, OPTIMAL, Outcome
from irc.targets import ObjectiveLevel

RESULT_VERSION = "1"

MOST_DIAGNOSTICS = 20
"""A result holds no more of them: a task can have thousands."""

MOST_CHARACTERS = 1000
"""Longer messages are cut."""


@dataclass(frozen=True, slots=True)
class RecordedFinding:
    """A diagnostic as another process wrote it."""

    content: Mapping[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The diagnostic as a JSON object."""
        return dict(self.content)


@dataclass(frozen=True, slots=True)
class BatchResult:
    """How a trial ended: its outcome, the objective values with their bounds, and its time.

    `solver` is the engine that gave the answer, `seconds` the wall-clock time with reading and
    checking, and `schedule` the document of the schedule where it was asked for.
    """

    task: str
    sha256: str
    target: str
    engine: str
    options: Mapping[str, Any] = field(repr=False)
    outcome: Outcome
    solver: str | None = None
    objective: tuple[ObjectiveLevel, ...] = ()
    seconds: float = 0.0
    schedule: Mapping[str, Any] | None = field(default=None, repr=False)

    @property
    def key(self) -> TrialKey:
        """The identity of the trial."""
        return trial_key(self.task, self.sha256, Pairing(self.target, self.engine), self.options)

    @property
    def status(self) -> str:
        """The status of the outcome."""
        return self.outcome.status

    @property
    def proven(self) -> bool:
        """Whether the answer is certain: the best schedule, or none exists."""
        return self.status in (OPTIMAL, INFEASIBLE)

    @property
    def gap(self) -> float | None:
        """How far the first objective that is not proven is from its bound: 0 to 1, 0 if all are.

        It is None without a schedule, or without a bound.
        """
        if not self.outcome.answered:
            return None
        if self.status == OPTIMAL:
            return 0.0
        gaps = (level.gap for level in self.objective)
        return next((gap for gap in gaps if gap != 0), 0.0)

    def __str__(self) -> str:
        """The result in a line."""
        values = ", ".join(f"{level.name} {level.value}" for level in self.objective)
        shown = f"{self.task}: {self.target} {self.engine}: {self.status}"
        return f"{shown}, {values}" if values else shown

    def to_dict(self) -> dict[str, Any]:
        """The object of the result's line."""
        document: dict[str, Any] = {
            "irc_result": RESULT_VERSION,
            "task": self.task,
            "sha256": self.sha256,
            "target": self.target,
            "engine": self.engine,
            "options": dict(self.options),
            "outcome": self.outcome.to_dict(),
            "solver": self.solver,
            "objective": [
                {
                    "name": level.name,
                    "value": json_number(level.value),
                    "bound": None if level.bound is None else json_number(level.bound),
                }
                for level in self.objective
            ],
            "seconds": self.seconds,
        }
        return document if self.schedule is None else {**document, "schedule": self.schedule}

    def line(self) -> str:
        """The result as a line of a results file, with its line end."""
        return json.dumps(self.to_dict(), ensure_ascii=False, allow_nan=False) + "\n"


def result_of(trial: Trial, answer: Mapping[str, Any]) -> BatchResult:
    """The result of a trial that a worker answered."""
    return _result(
        {
            "task": trial.task.name,
            "sha256": trial.task.sha256,
            "target": trial.pair.target,
            "engine": trial.pair.engine,
            "options": trial.options.to_dict(),
            **answer,
        }
    )


def read_result(line: str | bytes) -> BatchResult:
    """The result of a line. Raises `ValueError` where it is none."""
    document = json.loads(line)
    if not isinstance(document, dict) or document.get("irc_result") != RESULT_VERSION:
        raise ValueError("the line is no result of a batch")
    try:
        return _result(document)
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"the result is not whole: {error!r}") from None


def _result(document: Mapping[str, Any]) -> BatchResult:
    return BatchResult(
        document["task"],
        document["sha256"],
        document["target"],
        document["engine"],
        dict(document["options"]),
        _outcome(document["outcome"]),
        document.get("solver"),
        tuple(_level(level) for level in document.get("objective", ())),
        float(document.get("seconds", 0)),
        document.get("schedule"),
    )


def _outcome(document: Mapping[str, Any]) -> Outcome:
    findings = [RecordedFinding(finding) for finding in document["diagnostics"]]
    status, message = str(document["status"]), document["message"]
    return Outcome.of(status, findings, message, answered=bool(document["answered"]))


def _level(document: Mapping[str, Any]) -> ObjectiveLevel:
    bound = document.get("bound")
    value = parse_number(str(document["value"]))
    return ObjectiveLevel(
        document["name"], value, None if bound is None else parse_number(str(bound))
    )


def bounded(outcome: Outcome) -> dict[str, Any]:
    """An outcome's document, with a bounded number of diagnostics and bounded messages."""
    document = outcome.to_dict()
    document["message"] = _cut(document["message"])
    shown = document["diagnostics"][:MOST_DIAGNOSTICS]
    document["diagnostics"] = [
        {key: _cut(value) if isinstance(value, str) else value for key, value in finding.items()}
        for finding in shown
    ]
    return document


def _cut(text: str) -> str:
    return text if len(text) <= MOST_CHARACTERS else text[: MOST_CHARACTERS - 1] + "…"


def fault_of(trial: Trial) -> dict[str, Any] | None:
    """The answer of a trial whose task cannot be read: no worker is asked. None if it can be."""
    source = trial.task.source
    return {"outcome": bounded(InputError(source).outcome)} if isinstance(source, Report) else None


def ended_as(status: str, message: str, seconds: float = 0.0) -> dict[str, Any]:
    """The answer of a trial that ended without a schedule and without a worker's own answer."""
    return {"outcome": bounded(Outcome.of(status, (), message)), "seconds": round(seconds, 3)}
