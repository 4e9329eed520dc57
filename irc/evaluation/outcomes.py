"""The taxonomy of outcomes: right, wrong, no answer, or a service that failed.

An answer that is empty or cut off is a limit of the run; a service failure is no answer's fault.
Rates are given over all runs but service failures, and over delivered answers.
"""

from __future__ import annotations

from irc.evaluation.comparison import PLAN
from irc.evaluation.figure import Count, Table
from irc.evaluation.row import Row, Rows, count, rate
from irc.evaluation.scored import Scored
from irc.evaluation.tables import has_object, step_methods
from irc.methods import AnswerState


def outcome_table(scored: Scored) -> dict[str, Table]:
    """By method: how many runs ended how, and the rates of right plans."""
    methods = {name: (rows, PLAN[name]) for name, rows in step_methods(scored).items()}
    methods |= {
        "direct-cpsat": (scored.direct_cpsat, "plan"),
        "nl-cpsat": (scored.nl_cpsat, "plan"),
        "direct-pddl": (scored.direct_pddl, "plan"),
        "nl-pddl": (scored.nl_pddl, "plan"),
        "gold-pddl": (scored.gold_pddl, "plan"),
    }
    return {name: _outcomes(rows, measure) for name, (rows, measure) in methods.items()}


def _outcomes(rows: Rows, measure: str) -> Table:
    served = [row for row in rows.rows if not _failed(row, measure)]
    delivered = [row for row in served if has_object(row)]
    return {
        "runs": Count(len(rows.rows)),
        "right": count(served, lambda row: row.scores[measure]),
        "wrong": count(delivered, lambda row: not row.scores[measure]),
        "malformed": count(served, lambda row: row.state is AnswerState.MALFORMED),
        "empty": count(served, lambda row: row.state is AnswerState.EMPTY),
        "truncated": count(served, lambda row: row.state is AnswerState.TRUNCATED),
        "service_failure": count(rows.rows, lambda row: _failed(row, measure)),
        "overflow": count(rows.rows, lambda row: row.overflow),
        "of_served": rate(served, measure, 100),
        "of_delivered": rate(delivered, measure, 100),
    }


def _failed(row: Row, measure: str) -> bool:
    """Whether a service failed the run: a plan that was found all the same counts."""
    return row.service_failure and not row.scores[measure]
