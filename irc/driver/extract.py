"""Turns a raw answer to a compiled program into a validated schedule."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.driver.compile import lower_for, notes_on
from irc.driver.judge import Answer, _approved, finish
from irc.model import Task
from irc.model.canonical import task_sha256
from irc.problem.decisions import AnswerError
from irc.schedule import Status
from irc.targets import (
    MANIFEST_VERSION,
    Budget,
    EngineFailed,
    Outcome,
    get_backend,
)


def extract_answer(
    manifest: Mapping[str, Any],
    answer: str,
    *,
    manifest_source: Source | None = None,
    answer_name: str = "<answer>",
) -> Answer:
    """The schedule of a raw answer to a compiled program: decoded, re-timed, validated.

    Raises `InputError` if the manifest is not one of irc or the answer has no valid schedule; it
    shows the place in the manifest's text (if its source is given) or in the answer.
    """
    budget = Budget()
    task, target, names = _read_manifest(manifest, manifest_source)
    backend = get_backend(target)
    problem = lower_for(task, backend)
    try:
        schedule = backend.decode(problem, names, answer)
    except AnswerError as error:
        raise _bad_answer(str(error), answer, answer_name, error.line) from None
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ZeroDivisionError):
        message = "the manifest's 'names' do not fit its task; another version may have written it"
        diagnostic = Diagnostic(Code.BAD_ANSWER, message, ("names",))
        raise InputError(Report((diagnostic,), manifest_source)) from None
    outcome = Outcome(Status.FEASIBLE, "extract", schedule)
    schedule = finish(task, problem, outcome, target, budget.elapsed)
    try:
        approved = _approved(task, replace(schedule, engine=None))
        return Answer(approved, problem, notes_on(task))
    except EngineFailed as error:
        raise _bad_answer(str(error), answer, answer_name) from None


def _bad_answer(message: str, answer: str, name: str, line: int | None = None) -> InputError:
    """The error of a faulty answer, placed at one of its lines (without a line: at its start)."""
    offset = sum(len(text) + 1 for text in answer.split("\n")[: (line or 1) - 1])
    diagnostic = Diagnostic(
        Code.BAD_ANSWER,
        message,
        hint="give the whole output of the engine for the program of this manifest",
        offset=min(offset, len(answer)),
    )
    return InputError(Report((diagnostic,), Source(name, answer)))


def _read_manifest(
    manifest: Mapping[str, Any], source: Source | None
) -> tuple[Task, str, Mapping[str, Any]]:
    findings = Findings()
    if manifest.get("irc_manifest") != MANIFEST_VERSION:
        findings.add(
            Code.BAD_ANSWER,
            f"this is not a manifest of this version: 'irc_manifest' must be {MANIFEST_VERSION!r}",
            ("irc_manifest",),
            hint="give the manifest.json that `irc compile -o` wrote",
        )
        raise InputError(Report(tuple(findings.items), source))
    raw, target, names = (manifest.get(key) for key in ("task", "target", "names"))
    if (
        not isinstance(raw, Mapping)
        or not isinstance(target, str)
        or not isinstance(names, Mapping)
    ):
        findings.add(
            Code.BAD_ANSWER,
            "the manifest lacks 'task', 'target' or 'names'",
            hint="give the manifest.json that `irc compile -o` wrote",
        )
        raise InputError(Report(tuple(findings.items), source))
    from irc.model.from_document import to_task

    task = to_task(raw, findings)
    if task is None:
        raise InputError(Report(tuple(findings.items), source))
    if task_sha256(task) != manifest.get("task_sha256"):
        findings.add(
            Code.BAD_ANSWER,
            "the manifest was changed: its task has another hash",
            ("task_sha256",),
            hint="compile the task again; the answer may belong to the previous program",
        )
        raise InputError(Report(tuple(findings.items), source))
    return task, target, names
