"""Instances as a language model may see them: the question, and no gold value.

The fields that a prompt may show are listed by name. Everything else of an instance (its optimum,
its graph, its witness plan) stays outside, so no prompt can have it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from irc.diagnostics.fix import plain
from irc.errors import IrcError

if TYPE_CHECKING:
    from irc.model import Task
    from irc.model.quantities import Number

SHOWN_OF_STEPS = ("id", "question")
"""The fields of an instance of AsyncPlan-XXL or AsyncHow that are read."""

SHOWN_OF_KITCHEN = (
    *("id", "items", "goal", "action_durations", "stations", "robots", "temporal_constraints"),
    *("deadline", "candidate_goals", "inventory_limits"),
)
"""The fields of an instance of Robo Challenge that are read."""

SHOWN_OF_RUNNING = ("id", "news", "task", "now")
"""The fields of an instance of a running task that are read; the task's own events are not."""


class NotAnInstance(IrcError, ValueError):
    """An instance without the fields that a prompt needs."""


@dataclass(frozen=True)
class Instance:
    """A question in words, or a kitchen with its stations and robots."""

    id: str
    question: str
    kitchen: bool = False
    stations: Mapping[str, int] = field(default_factory=dict)
    robots: tuple[str, ...] = ()


@dataclass(frozen=True)
class RunningInstance(Instance):
    """A running task (irc's own), the time now, and the news in words as the question."""

    task: Task | None = None
    now: Number = 0


@dataclass(frozen=True)
class GoldInstance(Instance):
    """An instance with its gold task, for the method that asks no model; prompts never read it."""

    gold: Mapping[str, Any] = field(default_factory=dict)


def step_instance(raw: Mapping[str, Any]) -> Instance:
    """An instance of AsyncPlan-XXL or AsyncHow: its question. Raises `NotAnInstance`."""
    question = raw.get("question")
    if not isinstance(question, str) or not question.strip():
        raise NotAnInstance("the instance has no 'question', a text")
    return Instance(str(raw.get("id")), question)


def kitchen_instance(raw: Mapping[str, Any]) -> Instance:
    """An instance of Robo Challenge: what its kitchen has and wants. Raises `NotAnInstance`."""
    shown = {name: raw[name] for name in SHOWN_OF_KITCHEN if raw.get(name) is not None}
    missing = [name for name in ("items", "action_durations", "stations") if name not in shown]
    if missing:
        raise NotAnInstance(f"the instance has no '{missing[0]}'")
    document = json.dumps(plain({k: v for k, v in shown.items() if k != "id"}), indent=1)
    return Instance(
        str(shown.get("id")),
        f"```json\n{document}\n```",
        kitchen=True,
        stations=dict(shown["stations"]),
        robots=tuple(shown.get("robots", ())),
    )


def running_instance(raw: Mapping[str, Any]) -> RunningInstance:
    """A running task, the time now, and the news. Raises `NotAnInstance`."""
    from irc.checks import run_checks
    from irc.diagnostics import Findings, Report
    from irc.model.from_document import to_task
    from irc.model.quantities import TimeError
    from irc.model.times import parse_instant

    news, document = raw.get("news"), raw.get("task")
    if not isinstance(news, str) or not news.strip():
        raise NotAnInstance("the instance has no 'news', a text")
    if not isinstance(document, Mapping):
        raise NotAnInstance("the instance has no 'task', a document of the IR")
    findings = Findings()
    task = to_task({**document, "events": []}, findings)
    if task is not None:
        findings.items += run_checks(task, lint=False).report
    errors = Report(tuple(findings.items)).errors
    if task is None or errors:
        raise NotAnInstance(f"its task: {errors[0].message}")
    try:
        now = task.number(parse_instant(raw.get("now", 0)))
    except TimeError as error:
        raise NotAnInstance(f"its 'now': {error}") from None
    return RunningInstance(str(raw.get("id")), news, task=task, now=now)
