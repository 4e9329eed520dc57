"""Importer for PDDL2.1: makes an IR task with state of a temporal domain and a problem.

unified-planning (the extra `up`) reads the text; this package grounds it. A fact that changes is a
state variable `(at truck1 depot)`; a ground action is an action of the same name as in a plan,
`(drive truck1 depot market)`, which may occur as often as the planner likes; a timed initial
literal is an action with a fixed start. `irc.frontends.importers.pddl.plan` writes schedules back
as plans of the original problem. `docs/importers.md` lists supported and refused elements.
"""

from __future__ import annotations

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.importers.pddl.ground import DurationError, TooLargeError, ground
from irc.frontends.importers.pddl.lifted import UnexpectedError, lift
from irc.frontends.importers.pddl.reader import read_problem
from irc.frontends.importers.pddl.scope import Scope
from irc.frontends.importers.pddl.sexpr import Form, SyntaxFault, read_form
from irc.frontends.importers.pddl.task import UnreachableError, pddl_task
from irc.model import Task

__all__ = ["import_pddl"]

_LONGEST = 5_000_000
"""Longer files are refused: the reader takes minutes."""


def import_pddl(domain: tuple[str, str], problem: tuple[str, str]) -> Task:
    """The task of a domain and a problem, each given as (text, name of the file).

    Raises `InputError` with the unsupported elements and their places, and `EngineMissing` if
    unified-planning is not installed.
    """
    sources = (Source(domain[1], domain[0]), Source(problem[1], problem[0]))
    found = (Findings(), Findings())
    forms = [_form(s, f) for s, f in zip(sources, found, strict=True)]
    scope = Scope(*found)
    name = None if forms[0] is None else scope.check_domain(forms[0])
    if forms[1] is not None and forms[0] is not None:
        scope.check_problem(forms[1], name)
    _raise_any(sources, found)
    assert forms[1] is not None  # Otherwise there was a finding.
    title = forms[1].forms[0].words[1]
    try:
        lifted = lift(read_problem(*sources), name or "", title)
        return pddl_task(lifted, ground(lifted))
    except UnreachableError as error:
        offset = _place(forms[1], error.fact)
        found[1].add(Code.NOT_AN_IMPORT, str(error), offset=offset)
        raise InputError(Report(tuple(found[1].items), sources[1])) from None
    except (UnexpectedError, TooLargeError, DurationError) as error:
        message = f"{domain[1]} with {problem[1]}: {error}"
        raise InputError(Report((Diagnostic(Code.NOT_AN_IMPORT, message),))) from None


def _form(source: Source, findings: Findings) -> Form | None:
    if len(source.text) > _LONGEST:
        message = f"the file has {len(source.text):,} characters; the maximum is {_LONGEST:,}"
        findings.add(Code.NOT_AN_IMPORT, message, offset=0)
        return None
    try:
        return read_form(source.text)
    except SyntaxFault as fault:
        findings.add(Code.NOT_AN_IMPORT, str(fault), offset=fault.offset)
        return None


def _raise_any(sources: tuple[Source, Source], found: tuple[Findings, Findings]) -> None:
    """Raises the findings of both files; those of the second one have its name in the message."""
    shown = 0 if found[0].items else 1
    diagnostics = list(found[shown].items)
    if shown == 0:
        for d in found[1].items:
            line, column = sources[1].line_and_column(d.offset or 0)
            message = f"{sources[1].name}:{line}:{column}: {d.message}"
            diagnostics.append(Diagnostic(d.code, message, hint=d.hint, line=line, column=column))
    if diagnostics:
        raise InputError(Report(tuple(diagnostics), sources[shown]))


def _place(problem: Form, fact: tuple[str, ...]) -> int | None:
    goal = next((form for form in problem.forms if form.head == ":goal"), None)
    forms = [] if goal is None else [f for f in goal.all_forms() if tuple(f.words) == fact]
    return forms[0].offset if forms else None
