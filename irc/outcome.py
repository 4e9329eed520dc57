"""The outcome of a call or a command: one form for all stages (docs/outcomes.md)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

OUTCOME_VERSION = "1"

OPTIMAL, FEASIBLE = "optimal", "feasible"
INFEASIBLE, UNKNOWN, INTERRUPTED = "infeasible", "unknown", "interrupted"
REFUSED, FAULTY, MISUSED = "refused", "faulty", "misused"
MISSING, FAILED = "missing", "failed"

EXIT_STATUS: Mapping[str, int] = MappingProxyType(
    {
        OPTIMAL: 0,
        FEASIBLE: 0,
        INFEASIBLE: 1,
        REFUSED: 1,
        FAULTY: 1,
        MISUSED: 2,
        UNKNOWN: 3,
        MISSING: 4,
        FAILED: 4,
        INTERRUPTED: 130,
    }
)
"""The exit status of a command that ends with an outcome. SIGTERM interrupts with 143."""

_MESSAGES: Mapping[str, str] = MappingProxyType(
    {
        OPTIMAL: "this is the best schedule",
        FEASIBLE: "this is a schedule; whether it is the best is not proven",
        INFEASIBLE: "no schedule exists",
        UNKNOWN: "no schedule was found within the limits; one may exist",
        INTERRUPTED: "the search was ended before it was done",
        REFUSED: "the target cannot express this task",
        FAULTY: "the input has faults",
    }
)


class Finding(Protocol):
    """A diagnostic, as far as an outcome needs to know it."""

    def to_dict(self) -> dict[str, Any]:
        """The finding as a JSON object."""
        ...


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a call ended: its status, a sentence, and the diagnostics that say why.

    `status` is "optimal" or "feasible" (there is a schedule), "infeasible" (a proof that there is
    none), "unknown" (neither, within the limits), "interrupted", "refused" (the target cannot
    express the task), "faulty" (the input), "misused" (an option, a file that cannot be written),
    "missing" or "failed" (the engine). `answered`: there is a schedule, which there may also be
    where the search was interrupted.
    """

    status: str
    message: str
    diagnostics: tuple[Finding, ...] = ()
    answered: bool = False

    @classmethod
    def of(
        cls,
        status: str,
        diagnostics: Iterable[Finding] = (),
        message: str | None = None,
        *,
        answered: bool | None = None,
    ) -> Outcome:
        """The outcome with a status; the sentence is the usual one where none is given.

        Unless it says so itself, it is answered if the status is that of a schedule.
        """
        if answered is None:
            answered = status in (OPTIMAL, FEASIBLE)
        return cls(status, message or _MESSAGES[status], tuple(diagnostics), answered)

    @property
    def exit(self) -> int:
        """The exit status of a command that ends so."""
        return EXIT_STATUS[self.status]

    def __str__(self) -> str:
        """The outcome in a line."""
        return f"{self.status}: {self.message}"

    def to_dict(self) -> dict[str, Any]:
        """The object `outcome` of the JSON that a command prints."""
        return {
            "irc_outcome": OUTCOME_VERSION,
            "status": self.status,
            "exit": self.exit,
            "message": self.message,
            "answered": self.answered,
            "diagnostics": [finding.to_dict() for finding in self.diagnostics],
        }
