"""An explanation: why there is no schedule, or why the schedule is not shorter."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from irc.diagnostics import Diagnostic
from irc.diagnostics.source import Pointer, Source, pointer_text
from irc.model.quantities import Number
from irc.model.times import format_number, json_number
from irc.outcome import INTERRUPTED, Outcome
from irc.schedule import Schedule, Status

EXPLANATION_VERSION = "1"


@dataclass(frozen=True, slots=True)
class RenderedStatement:
    """A statement in the words of the task, with its place in the document and in its text.

    `kind` is that of the statement. `side` ("min" or "max") is the limit that binds, if the
    statement has two limits and only one binds.
    """

    kind: str
    text: str
    pointer: Pointer
    side: str | None = None
    line: int | None = None
    column: int | None = None
    offset: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """The object in `conflict`."""
        shown: dict[str, Any] = {
            "kind": self.kind,
            "text": self.text,
            "pointer": pointer_text(self.pointer),
            "line": self.line,
            "column": self.column,
        }
        return shown if self.side is None else {**shown, "side": self.side}


@dataclass(frozen=True, slots=True)
class ChainStep:
    """A link of the critical chain, in the task's time unit.

    Its `statement.kind` is that of a statement, "hand_over" (an action takes at once what another
    frees), "order" (the order of two actions in the schedule, although there is room for both) or
    "time" (t = 0).
    """

    statement: RenderedStatement
    start: Number
    end: Number

    def to_dict(self) -> dict[str, Any]:
        """The object in `chain`."""
        return {
            **self.statement.to_dict(),
            "from": json_number(self.start),
            "to": json_number(self.end),
            "length": json_number(self.end - self.start),
        }


@dataclass(frozen=True)
class Explanation:
    """The result of `irc.explain`.

    - No schedule exists: `conflict` has statements that cannot hold together; if `minimal`, the
      others can hold without any one of them. `reason` is a bound in words, if there is one.
    - A schedule exists: `chain` is its critical chain (None: it could end earlier in the same
      order), `slack` is how much later each action could start, and `proof` says whether a shorter
      schedule may exist.
    - Neither is known within the limits: `status` is "unknown".

    `interrupted`: the search was ended before it was done, so that the conflict may have statements
    that are not needed, or the schedule may not be the shortest.
    """

    status: Status
    task: str | None
    time_unit: str
    conflict: tuple[RenderedStatement, ...] = ()
    minimal: bool = True
    by: str | None = None
    reason: str | None = None
    schedule: Schedule | None = None
    chain: tuple[ChainStep, ...] | None = ()
    slack: dict[str, Number] = field(default_factory=dict)
    bound: Number | None = None
    proof: str | None = None
    seconds: float | None = None
    source: Source | None = None
    interrupted: bool = False
    reasons: tuple[Diagnostic, ...] = field(default=(), repr=False)

    @property
    def outcome(self) -> Outcome:
        """How the explanation ended, with the diagnostics that say why there is no schedule."""
        if self.interrupted:
            return Outcome.of(INTERRUPTED, self.reasons, answered=self.feasible is True)
        return Outcome.of(str(self.status), self.reasons)

    @property
    def feasible(self) -> bool | None:
        """Whether the task has a schedule; None if that is not known."""
        if self.status is Status.UNKNOWN:
            return None
        return self.status is not Status.INFEASIBLE

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc explain --format json` prints."""
        shown: dict[str, Any] = {
            "irc_explanation": EXPLANATION_VERSION,
            "task": self.task,
            "feasible": self.feasible,
            "status": str(self.status),
            **({"interrupted": True} if self.interrupted else {}),
        }
        if self.status is Status.INFEASIBLE:
            shown |= {
                "conflict": [statement.to_dict() for statement in self.conflict],
                "minimal": self.minimal,
                "by": self.by,
                "reason": self.reason,
            }
        elif self.schedule is not None:
            shown |= {
                "makespan": json_number(self.schedule.makespan),
                "bound": None if self.bound is None else json_number(self.bound),
                "proof": self.proof,
                "chain": None if self.chain is None else [step.to_dict() for step in self.chain],
                "slack": {name: json_number(value) for name, value in self.slack.items()},
            }
        if not self.outcome.answered:
            shown["outcome"] = self.outcome.to_dict()
        return {**shown, "seconds": self.seconds}

    def _repr_html_(self) -> str:
        """The same for notebooks, with a picture in which what is critical stands out."""
        from irc.display.html import heading, items
        from irc.display.svg import bars_svg

        head, *lines = str(self).split("\n")
        picture = ""
        if self.schedule is not None:
            critical = {name for name, slack in self.slack.items() if not slack}
            picture = bars_svg(self.schedule.bars(critical), self.time_unit, head)
        return heading(head) + picture + (items(line.strip() for line in lines) if lines else "")

    def __str__(self) -> str:
        """The headline and one line for each statement or link."""
        if self.status is Status.INFEASIBLE:
            head = f"{self.task or 'task'}: infeasible, these statements cannot hold together"
            return "\n".join([head, *(f"  {statement.text}" for statement in self.conflict)])
        if self.schedule is None:
            return f"{self.task or 'task'}: unknown"
        makespan = format_number(self.schedule.makespan)
        head = f"{self.task or 'task'}: makespan {makespan} {self.time_unit}"
        return "\n".join(
            [
                head,
                *(
                    f"  {format_number(s.start)} {self.time_unit}  {s.statement.text}"
                    for s in self.chain or ()
                ),
            ]
        )


def located(
    statements: Iterable[RenderedStatement], source: Source | None
) -> tuple[RenderedStatement, ...]:
    """The same statements in the same order, with line and column if there is a text."""
    listed = tuple(statements)
    if source is None:
        return listed
    places = source.locate([t.pointer for t in listed])
    found = []
    for t in listed:
        place = places.get(t.pointer)
        if place is not None:
            line, column = source.line_and_column(place.start)
            t = replace(t, line=line, column=column, offset=place.start)
        found.append(t)
    return tuple(found)
