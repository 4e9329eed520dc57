"""Diagnostics: each finding with its severity, message, place and hint."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import TYPE_CHECKING, Any

from irc.diagnostics.source import Pointer, Source, pointer_text

if TYPE_CHECKING:
    from irc.diagnostics.fix import Fix, TextEdit


DIAGNOSTICS_VERSION = "1"


class Severity(StrEnum):
    """The severity of a finding; only an error stops a compilation."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Code(Enum):
    """Every diagnostic of the project: its stable code, its severity and a summary.

    A new member comes with its entry in `irc/diagnostics/catalogue/` and a row in `tests/corpus/`.
    """

    UNREADABLE = ("IRC001", Severity.ERROR, "the input cannot be read as text")
    SYNTAX = ("IRC002", Severity.ERROR, "the text is not valid JSON")
    SURROUNDED = ("IRC003", Severity.NOTE, "there is other text around the JSON document")
    DUPLICATE_KEY = ("IRC004", Severity.ERROR, "an object has the same key twice")
    BAD_NUMBER = (
        "IRC005",
        Severity.ERROR,
        "a number that JSON does not have, or a number out of range",
    )
    TOO_LARGE = ("IRC006", Severity.ERROR, "the input is too large or nested too deeply")
    BYTE_ORDER_MARK = ("IRC007", Severity.NOTE, "the text starts with a byte-order mark")

    DSL_SYNTAX = ("IRC010", Severity.ERROR, "a statement of the DSL that cannot be read")
    DSL_TEXT = ("IRC011", Severity.ERROR, "text in quotes that is not closed or cannot be read")
    DSL_INDENTATION = ("IRC012", Severity.ERROR, "indentation that belongs to no statement")
    DSL_NAME = ("IRC013", Severity.ERROR, "a name that cannot be written without quotes")
    DSL_TWICE = (
        "IRC014",
        Severity.ERROR,
        "a statement or clause that may appear once appears twice",
    )
    DSL_INCLUDE = ("IRC015", Severity.ERROR, "an include that cannot be read or is not allowed")
    DSL_TEMPLATE = ("IRC016", Severity.ERROR, "braces, or a `for`, that cannot be filled in")
    DSL_EXPANSION = ("IRC017", Severity.ERROR, "a text that would grow without bounds")
    DSL_POOL = ("IRC018", Severity.ERROR, "a pool that contradicts another declaration")

    NOT_UNDERSTOOD = ("IRC020", Severity.ERROR, "a sentence that is not understood")
    AMBIGUOUS = ("IRC021", Severity.ERROR, "a sentence that has more than one exact meaning")
    VAGUE = ("IRC022", Severity.ERROR, "a vague word where an exact one is needed")
    CONDITIONAL = ("IRC023", Severity.ERROR, "a negation, condition or exception not understood")
    UNKNOWN_STEP = ("IRC024", Severity.ERROR, "a sentence about a step that is not listed")
    NO_DURATION = ("IRC025", Severity.ERROR, "a step without a duration")
    NO_ORDER = ("IRC026", Severity.ERROR, "a text that does not say in which order")
    CONTRADICTION = ("IRC027", Severity.ERROR, "a sentence that contradicts another one")
    LIMITED = ("IRC028", Severity.ERROR, "a limit on people or things that is not exact")
    NO_STEPS = ("IRC029", Severity.ERROR, "a text without a list of steps")

    MISSING_FIELD = ("IRC101", Severity.ERROR, "a required field is missing")
    UNKNOWN_FIELD = ("IRC102", Severity.ERROR, "a field that the IR does not have")
    WRONG_TYPE = ("IRC103", Severity.ERROR, "a value of the wrong type or shape")
    BAD_TIME = ("IRC104", Severity.ERROR, "a time that cannot be read")
    NEGATIVE_TIME = ("IRC105", Severity.ERROR, "a negative duration or point in time")
    EMPTY_RANGE = ("IRC106", Severity.ERROR, "a range whose minimum is above its maximum")
    NOT_AN_IMPORT = ("IRC107", Severity.ERROR, "the input is not in the importer's format")
    ROUNDED = ("IRC108", Severity.NOTE, "a time that is rounded to the resolution")
    COARSE_RESOLUTION = ("IRC109", Severity.ERROR, "a resolution coarser than a duration")
    LENIENT = ("IRC110", Severity.WARNING, "an input that is read differently from what it says")

    UNKNOWN_NAME = ("IRC201", Severity.ERROR, "a reference to something that is not declared")
    DUPLICATE_ID = ("IRC202", Severity.ERROR, "an id given twice with different contents")
    REPEATED = ("IRC203", Severity.WARNING, "the same thing is stated twice, word for word")
    SELF_EDGE = ("IRC204", Severity.ERROR, "an action that must precede itself")
    EMPTY_CHOICE = ("IRC205", Severity.ERROR, "a choice with nothing to choose from")
    REPEATED_CHOICE = ("IRC206", Severity.WARNING, "a choice that names the same thing twice")
    WRONG_KIND = ("IRC207", Severity.ERROR, "a resource or variable of the wrong kind for this use")
    OCCURRENCE = (
        "IRC208",
        Severity.ERROR,
        "an action that may occur more than once, used where only one occurrence may be",
    )
    GROUPING = ("IRC209", Severity.ERROR, "group membership that contradicts itself")
    UNKNOWN_VALUE = ("IRC210", Severity.ERROR, "a value that the state variable does not have")
    INCOMPLETE = ("IRC211", Severity.ERROR, "a declaration that lacks what it needs")
    WITHOUT_EFFECT = ("IRC212", Severity.WARNING, "a field that has no meaning here")
    OVERLAP = ("IRC213", Severity.ERROR, "windows that overlap")
    TOO_MANY = ("IRC214", Severity.ERROR, "more occurrences than irc can plan")
    SETUPS = ("IRC217", Severity.ERROR, "set-ups that contradict each other or their resource")
    FAMILY = ("IRC218", Severity.WARNING, "a family that no set-up names, or that a load lacks")
    SEQUENCE = (
        "IRC219",
        Severity.ERROR,
        "an order of uses that its resource or its actions do not allow",
    )

    CYCLE = ("IRC301", Severity.ERROR, "actions that wait for each other")
    WINDOW = ("IRC302", Severity.ERROR, "a time window too small for its action")
    TOO_LATE = ("IRC303", Severity.ERROR, "a deadline that no schedule can meet")
    DEMAND = ("IRC304", Severity.ERROR, "a demand above the capacity")
    LAGS = ("IRC305", Severity.ERROR, "lags that contradict each other")
    UNREACHABLE = ("IRC306", Severity.ERROR, "a value that a state variable can never have")
    STOCK = ("IRC307", Severity.ERROR, "a stock that runs out or overflows in every order")
    AT_ODDS = ("IRC308", Severity.ERROR, "conditions, effects or goals that contradict each other")
    NEVER = ("IRC309", Severity.ERROR, "an action that is required and may never occur")
    NO_SCHEDULE = ("IRC310", Severity.ERROR, "a task that an engine proved to have no schedule")

    UNUSED = ("IRC401", Severity.WARNING, "a resource that no action uses")
    REDUNDANT = ("IRC402", Severity.NOTE, "a precedence that follows from others")

    UNSUPPORTED = ("IRC501", Severity.ERROR, "a feature that the target does not support")
    OUT_OF_RANGE = ("IRC502", Severity.ERROR, "numbers beyond the target's range")
    LATER_EVENTS = ("IRC503", Severity.NOTE, "events that are not known at t = 0")

    BAD_SCHEDULE = ("IRC601", Severity.ERROR, "a schedule file that cannot be read")
    BAD_ANSWER = ("IRC602", Severity.ERROR, "an engine's answer that cannot be used")
    DAMAGED = ("IRC603", Severity.WARNING, "damaged lines in an engine's answer")
    NO_ANSWER = ("IRC604", Severity.NOTE, "an engine found no answer within its limits")
    BAD_JOURNAL = ("IRC605", Severity.ERROR, "a journal that cannot be continued")
    TORN_JOURNAL = ("IRC606", Severity.NOTE, "a journal whose last line was cut off")
    OTHER_JOURNAL = ("IRC607", Severity.ERROR, "a journal of another task or schedule")
    CHANGED_TASK = ("IRC608", Severity.ERROR, "a task that has changed since its journal was begun")
    JOURNAL_VERSION = ("IRC609", Severity.ERROR, "a journal of another version of irc")
    MENDED_JOURNAL = ("IRC610", Severity.WARNING, "damage of a journal that loses nothing")

    TAKEN_ID = ("IRC701", Severity.ERROR, "an event that adds an id which is already there")
    OVER = ("IRC702", Severity.ERROR, "an event about an action that can no longer happen")
    NOTHING_TO_REMOVE = ("IRC703", Severity.ERROR, "an event that removes what is not there")
    UNSUITED_CHANGE = ("IRC704", Severity.ERROR, "a change that does not fit its element")
    EVENT_TIME = ("IRC705", Severity.ERROR, "a time that contradicts the event's own")
    ALREADY_DONE = ("IRC707", Severity.ERROR, "an event about an action that has ended")
    OBSERVED = ("IRC708", Severity.ERROR, "an observation that contradicts another one")
    CARRIED = ("IRC709", Severity.WARNING, "a conflict that the history alone causes")
    NO_CONTINUATION = ("IRC710", Severity.ERROR, "a history that no schedule continues")
    NOT_AS_PLANNED = ("IRC711", Severity.WARNING, "an action that cannot have begun as planned")
    CORRECTED = ("IRC712", Severity.WARNING, "an observation that another one corrects")
    LAPSED = ("IRC713", Severity.WARNING, "what lapses with an action that is cancelled")

    def __init__(self, id: str, severity: Severity, summary: str) -> None:
        self.id = id
        self.severity = severity
        self.summary = summary

    @property
    def proves_infeasible(self) -> bool:
        """Whether an error of this code is a proof that there is no schedule."""
        return self.id.startswith("IRC3") or self is Code.NO_CONTINUATION


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding. `offset` is its place in the text, if no element of the document gives one.

    `within` is its text, if that is not the report's own: a file that the task includes. `fix` is
    a certain repair as JSON patch operations; it is empty if there is none. `edits` are a certain
    repair of the text itself, where it is not JSON and patches do not apply.
    """

    code: Code
    message: str
    pointer: Pointer = ()
    hint: str | None = None
    at_key: bool = False
    offset: int | None = None
    line: int | None = None
    column: int | None = None
    within: Source | None = None
    fix: Fix = ()
    edits: tuple[TextEdit, ...] = ()
    end: int | None = None
    """The offset at which the faulty text ends, if it is known and on the same line."""

    @property
    def severity(self) -> Severity:
        """The severity of its code."""
        return self.code.severity

    def to_dict(self) -> dict[str, Any]:
        """The machine-readable form (design: "Diagnostics"); "file" only for an included one."""
        found = {
            "code": self.code.id,
            "severity": str(self.severity),
            "message": self.message,
            "pointer": pointer_text(self.pointer),
            "line": self.line,
            "column": self.column,
            "hint": self.hint,
            "fix": [operation.to_dict() for operation in self.fix] or None,
        }
        if self.edits:
            found["edits"] = [edit._asdict() for edit in self.edits]
        return found if self.within is None else {**found, "file": self.within.name}


def _row(d: Diagnostic) -> tuple[str, ...]:
    """A located finding as a row of a table."""
    place = pointer_text(d.pointer) if d.line is None else f"{d.line}:{d.column}"
    return str(d.severity), d.code.id, d.message, place, d.hint or ""
