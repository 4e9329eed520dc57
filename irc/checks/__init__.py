"""All checks of a task, in one run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from irc.checks.structure import check_structure
from irc.checks.temporal import check_temporal
from irc.diagnostics import Diagnostic, Findings, Report
from irc.lower import lower
from irc.model import Task
from irc.passes.mandatory import mandatory_part
from irc.problem import Problem


@dataclass(frozen=True)
class Checked:
    """A task with all that the checks say of it, and its lowered form."""

    task: Task
    problem: Problem
    report: Report


def run_checks(task: Task, earlier: Iterable[Diagnostic] = (), *, lint: bool = True) -> Checked:
    """Checks a task: structure, time, and (with `lint`) what is probably not meant.

    `earlier` are findings from reading the text; they stand first in the report.
    """
    findings = Findings(list(earlier))
    check_structure(task, findings)
    problem = lower(task)
    # What cannot hold of the part that every schedule contains cannot hold at all.
    core = mandatory_part(problem)
    check_temporal(core, findings)
    if lint:
        from irc.checks.lint import check_lint

        check_lint(task, core, findings)
    return Checked(task, problem, Report(tuple(findings.items), task.source))
