"""Importer for PDDL2.1: makes an IR task with state of a temporal domain and a problem.

A fact that changes is a state variable `(at truck1 depot)`; a ground action is an action of the
same name as in a plan, `(drive truck1 depot market)`, which may occur as often as the planner
likes; a timed initial literal is a timed change of state.
`irc.frontends.importers.pddl.plan` writes schedules back as plans of the original problem.
`docs/importers.md` lists supported and refused elements.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.importers.pddl.formula import NotSupportedError
from irc.frontends.importers.pddl.ground import DurationError, UnreachableError, ground
from irc.frontends.importers.pddl.join import TooLargeError
from irc.frontends.importers.pddl.lifted import Lifted
from irc.frontends.importers.pddl.metric import objective_of
from irc.frontends.importers.pddl.plan_reader import original_steps
from irc.frontends.importers.pddl.reader import Reader
from irc.frontends.importers.pddl.sexpr import Form, SyntaxFault, read_form
from irc.frontends.importers.pddl.symmetry import without_symmetry
from irc.frontends.importers.pddl.task import pddl_task
from irc.model import Task
from irc.model.garbage import without_garbage
from irc.model.original import Original

__all__ = ["import_pddl", "read_pddl"]

_LONGEST = 5_000_000
"""Longer files are refused: the reader takes minutes."""

_MIXED = "the metric weighs time against cost; irc minimizes the makespan first, then the cost"


def import_pddl(domain: tuple[str, str], problem: tuple[str, str]) -> Task:
    """The task of a domain and a problem, each given as (text, name of the file).

    Raises `InputError` with the unsupported elements and their places.
    """
    return read_pddl(domain, problem)[0]


def read_pddl(
    domain: tuple[str, str], problem: tuple[str, str], *, lenient: bool = False
) -> tuple[Task, Report]:
    """The task of a domain and a problem, and warnings about what was read differently.

    `lenient` takes habits of language models that PDDL does not allow, each with a warning: objects
    of the problem in the domain, missing `:parameters`, another domain's name, and a parenthesis
    too many at the end. Raises `InputError` with the unsupported elements and their places.
    """
    sources = (Source(domain[1], domain[0]), Source(problem[1], problem[0]))
    found = (Findings(), Findings())
    forms = [_form(s, f, lenient) for s, f in zip(sources, found, strict=True)]
    lifted = Reader(*found, lenient=lenient).read(forms[0], forms[1])
    _raise_errors(sources, found)
    with without_garbage():
        task = _task(lifted, sources, found)
    task = task.with_original(Original(domain[0], problem[0], partial(original_steps, task)))
    return task, _report(sources, found)


def _task(lifted: Lifted, sources: tuple[Source, Source], found: tuple[Findings, Findings]) -> Task:
    try:
        grounded = ground(lifted)
    except UnreachableError as error:
        found[1].add(Code.NOT_AN_IMPORT, str(error), offset=error.offset)
    except NotSupportedError as error:
        found[0].add(Code.NOT_AN_IMPORT, str(error), offset=error.offset)
    except (TooLargeError, DurationError) as error:
        message = f"{sources[0].name} with {sources[1].name}: {error}"
        raise InputError(Report((Diagnostic(Code.NOT_AN_IMPORT, message),))) from None
    else:
        try:
            objective = objective_of(lifted, grounded.actions)
            for message, offset in grounded.cut:
                found[0].add(Code.LENIENT, message, offset=offset)
            if objective.mixed and lifted.metric is not None:
                found[1].add(Code.LENIENT, _MIXED, offset=lifted.metric.offset)
            grounded, equal = without_symmetry(lifted, grounded)
            return pddl_task(lifted, grounded, objective, equal)
        except (NotSupportedError, UnreachableError) as error:
            found[1].add(Code.NOT_AN_IMPORT, str(error), offset=error.offset)
    _raise_errors(sources, found)
    raise AssertionError("a fault was recorded and not raised")


def _form(source: Source, findings: Findings, lenient: bool) -> Form | None:
    if len(source.text) > _LONGEST:
        message = f"the file has {len(source.text):,} characters; the maximum is {_LONGEST:,}"
        findings.add(Code.NOT_AN_IMPORT, message, offset=0)
        return None
    try:
        return read_form(source.text)
    except SyntaxFault as fault:
        if lenient and fault.form is not None:
            message = f"{fault}; what follows is not read"
            findings.add(Code.LENIENT, message, offset=fault.offset)
            return fault.form
        findings.add(Code.NOT_AN_IMPORT, str(fault), offset=fault.offset)
        return None


def _raise_errors(sources: tuple[Source, Source], found: tuple[Findings, Findings]) -> None:
    if not _report(sources, found).ok:
        raise InputError(_report(sources, found))


def _report(sources: tuple[Source, Source], found: tuple[Findings, Findings]) -> Report:
    """The findings of both files; those of the second one have its name in the message."""
    shown = 0 if found[0].items else 1
    diagnostics = list(found[shown].items)
    if shown == 0:
        for d in found[1].items:
            line, column = sources[1].line_and_column(d.offset or 0)
            message = f"{sources[1].name}:{line}:{column}: {d.message}"
            diagnostics.append(replace(d, message=message, offset=None, line=line, column=column))
    return Report(tuple(diagnostics), sources[shown])
