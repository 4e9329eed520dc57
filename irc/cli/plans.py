"""Plans of an original PDDL problem where a schedule or an engine's output is expected."""

from __future__ import annotations

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.driver.extract import extract_answer
from irc.driver.judge import Answer
from irc.driver.retimed import retimed_answer
from irc.errors import IrcError
from irc.frontends.files import read_task
from irc.frontends.importers.pddl.plan_reader import is_from_pddl, read_plan
from irc.frontends.json.document import read_document
from irc.frontends.texts import read_bytes, read_text
from irc.model import Task
from irc.problem.decisions import AnswerError
from irc.schedule import Schedule
from irc.schedule.reading import schedule_from_json


def read_schedule(path: str, task: Task) -> tuple[Schedule, Source]:
    """The schedule of a file: JSON, or for a task from PDDL also a plan of the original."""
    text, name = read_text(path)
    if is_from_pddl(task) and "{" not in text:
        return read_plan(text, name, task), Source(name, text)
    document = read_document(text, name)
    return schedule_from_json(document.content, document.source), document.source


def extracted(manifest: str, answer: str, problem: str | None) -> Answer:
    """The schedule of an engine's output, or of a plan of the original PDDL problem.

    With a `problem`, `manifest` is the domain. The manifest of a task from PDDL takes both.
    """
    if problem is not None:
        task = read_task(manifest, problem).task
        return _retimed(task, *read_text(answer))
    document = read_document(*read_text(manifest))
    raw, name = read_bytes(answer)
    text = raw.decode("utf-8", "replace")
    try:
        return extract_answer(
            document.content, text, manifest_source=document.source, answer_name=name
        )
    except InputError:
        original = _original(document.content.get("task"), text, name)
        if original is None:
            raise
        return _retimed(original[0], text, name)


def _original(raw: object, text: str, name: str) -> tuple[Task, Schedule] | None:
    """The task of a manifest and a schedule, if the text is a plan of its original PDDL problem."""
    from irc.model.from_document import to_task

    task = to_task(raw, Findings()) if isinstance(raw, dict) else None
    if task is None or not is_from_pddl(task):
        return None
    try:
        schedule = read_plan(text, name, task)
    except IrcError:
        return None
    return (task, schedule) if schedule.entries else None


def _retimed(task: Task, text: str, name: str) -> Answer:
    try:
        return retimed_answer(task, read_plan(text, name, task))
    except AnswerError as error:
        found = Diagnostic(Code.BAD_ANSWER, str(error), offset=0)
        raise InputError(Report((found,), Source(name, text))) from None
