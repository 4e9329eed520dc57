"""State-aware repair: the model reads news in words and writes the changes; irc applies them.

The task is irc's own running one, so no later stage is built from a gold task, and the prompt has
the news and not the changes.
"""

from __future__ import annotations

import json

from irc.diagnostics import InputError, Report
from irc.events import apply
from irc.frontends.events import to_events
from irc.frontends.importers.json_answer import placed_object
from irc.frontends.json.document import json_source
from irc.methods.answer import Answer, AnswerState
from irc.methods.instance import Instance, RunningInstance
from irc.methods.prompt import Message, asked, schema_text
from irc.methods.written_answer import unreadable
from irc.model import Task
from irc.model.canonical import written_task
from irc.model.nulls import without_nulls
from irc.model.quantities import Number
from irc.model.times import json_number

EXPECTED = '{"changes": [{"op": …}]}'


def repair_messages(instance: Instance) -> list[Message]:
    """The prompt with the running task, the time and the news."""
    task, now = _running(instance)
    shown = written_task(task)
    shown.pop("events", None)  # What is still to come is not known to the model.
    return asked(
        "state-aware-repair",
        question=instance.question,
        schema=schema_text("event"),
        task=json.dumps(shown, ensure_ascii=False),
        now=f"{json_number(now)} {task.time_unit}",
    )


def read_repair(text: str, instance: Instance) -> Answer:
    """The changes that the model wrote, as an event, and the task as the event revises it."""
    task, now = _running(instance)
    found = placed_object(text)
    if found is None:
        return unreadable(text, EXPECTED)
    content, start = found
    source = json_source("answer", text, start)
    written = {**without_nulls(content), "at": json_number(now)}
    try:
        (event,) = to_events([written], lambda _: (), json_number(now), source)
        revised = apply(task, event, source=source)
    except InputError as error:
        return Answer(AnswerState.INVALID, text, report=Report(error.report.diagnostics, source))
    return Answer(AnswerState.OK, text, document=written_task(revised), event=event)


def _running(instance: Instance) -> tuple[Task, Number]:
    if not isinstance(instance, RunningInstance) or instance.task is None:
        message = f"state-aware-repair needs a RunningInstance with a task, not {instance!r:.40}"
        raise TypeError(message)
    return instance.task, instance.now
