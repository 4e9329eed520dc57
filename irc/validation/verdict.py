"""The verdict of the validator: every violation in the task's own words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from types import MappingProxyType
from typing import Any

from irc.diagnostics.listing import and_more
from irc.model.objectives import is_time
from irc.model.quantities import Number
from irc.model.times import format_number, json_number

SHOWN_PER_RULE = 50
"""At most this many violations of one rule are reported; `Verdict.omitted` counts the rest."""

RULES: Mapping[str, int | None] = MappingProxyType(
    {
        "unknown": 1,
        "status": 1,
        "presence": 1,
        "occurrence": 1,
        "group": 1,
        "selection": 1,
        "coupling": 2,
        "mode": 2,
        "duration": 2,
        "start": 2,
        "release": 2,
        "deadline": 2,
        "latest_start": 2,
        "calendar": 2,
        "pause": 2,
        "earliest_end": 2,
        "precedence": 3,
        "resources": 4,
        "capacity": 4,
        "setup": 4,
        "idle": 4,
        "sequence": 4,
        "load": 4,
        "reservoir": 5,
        "rank": 6,
        "interference": 6,
        "bounds": 6,
        "state": 6,
        "goal": 7,
        "undecided": None,
        "objective": None,
    }
)
"""Each rule's short name, and the number it has in docs/semantics.md.

`undecided` says that a bounded search gave up, `objective` that the schedule states a wrong value
or bound; neither is a rule of its own there.
"""

_NAMED_IN_A_MESSAGE = 5


@dataclass(frozen=True, slots=True)
class Violation:
    """One way in which a schedule breaks a rule; times are in the task's unit."""

    rule: str
    number: int | None
    message: str
    actions: tuple[str, ...] = ()
    times: tuple[Number, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """The machine-readable form; times as in a schedule document."""
        return {
            "rule": self.rule,
            "number": self.number,
            "message": self.message,
            "actions": list(self.actions),
            "times": [json_number(t) for t in self.times],
        }

    def __str__(self) -> str:
        place = self.rule if self.number is None else f"rule {self.number}, {self.rule}"
        return f"{place}: {self.message}"


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a schedule is valid, every reason why not, and its objective values.

    `objective` holds the values computed here from the entries: makespan, tardiness (in the task's
    unit), reward and cost, and where there are set-ups their time and their cost. `omitted` counts
    the violations beyond `SHOWN_PER_RULE` of each rule.

    As of a time `at`, `carried` holds the violations that the history alone causes: no plan for
    the open entries can avoid them, and they do not make the schedule invalid.
    """

    violations: tuple[Violation, ...]
    objective: Mapping[str, Number]
    omitted: Mapping[str, int] = field(default_factory=dict)
    time_unit: str = "s"
    at: Number | None = None
    carried: tuple[Violation, ...] = ()
    carried_omitted: Mapping[str, int] = field(default_factory=dict)

    @property
    def valid(self) -> bool:
        """Whether every rule is known to hold."""
        return not self.violations

    @property
    def undecided(self) -> bool:
        """Whether the only finding is that a bounded search gave up."""
        return bool(self.violations) and all(v.rule == "undecided" for v in self.violations)

    @property
    def makespan(self) -> Number:
        """The latest end; 0 for an empty schedule."""
        return self.objective["makespan"]

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc validate --format json` prints."""
        document: dict[str, Any] = {
            "irc_verdict": "1",
            "valid": self.valid,
            "undecided": self.undecided,
            "makespan": json_number(self.makespan),
            "objective": {name: json_number(value) for name, value in self.objective.items()},
            "violations": [v.to_dict() for v in self.violations],
            "omitted": dict(self.omitted),
        }
        if self.at is not None:
            document["at"] = json_number(self.at)
            document["carried"] = [v.to_dict() for v in self.carried]
            document["carried_omitted"] = dict(self.carried_omitted)
        return document

    def _repr_html_(self) -> str:
        """The verdict as HTML, for notebooks."""
        from irc.display.html import heading, items

        head, *lines = str(self).split("\n")
        return heading(head) + (items(line.strip() for line in lines) if lines else "")

    def __str__(self) -> str:
        if self.valid:
            lines = [f"valid: {self._objectives_text()}"]
        else:
            head = "undecided" if self.undecided else "not valid"
            lines = [f"{head}, {_count(self.violations, self.omitted)}:"]
            lines += _listing(self.violations, self.omitted)
        if self.at is not None and self.carried:
            count = _count(self.carried, self.carried_omitted)
            before = f"{format_number(self.at)} {self.time_unit}"
            began = f"entries that began before {before}"
            lines.append(f"note: {count} carried, caused only by {began}:")
            lines += _listing(self.carried, self.carried_omitted)
        return "\n".join(lines)

    def _objectives_text(self) -> str:
        units = {name: f" {self.time_unit}" for name in self.objective if is_time(name)}
        return ", ".join(
            f"{name.replace('_', ' ')} {format_number(value)}{units.get(name, '')}"
            for name, value in self.objective.items()
            if value or name == "makespan"
        )


def _count(shown: Sequence[Violation], omitted: Mapping[str, int]) -> str:
    count = len(shown) + sum(omitted.values())
    return f"{count} violation{'s' if count > 1 else ''}"


def _listing(shown: Sequence[Violation], omitted: Mapping[str, int]) -> list[str]:
    lines = [f"  {violation}" for violation in shown]
    return lines + [f"  … and {more} more of rule {rule}" for rule, more in omitted.items()]


class _Collection:
    """The violations that are reported, and the number of all of each rule."""

    def __init__(self) -> None:
        self.shown: list[Violation] = []
        self.count: Counter[str] = Counter()

    def merge(self, other: _Collection) -> None:
        for violation in other.shown:
            if sum(v.rule == violation.rule for v in self.shown) < SHOWN_PER_RULE:
                self.shown.append(violation)
        self.count.update(other.count)

    @property
    def in_order(self) -> tuple[Violation, ...]:
        return tuple(sorted(self.shown, key=lambda v: (v.number is None, v.number or 0)))

    @property
    def omitted(self) -> dict[str, int]:
        return {
            rule: count - SHOWN_PER_RULE
            for rule, count in self.count.items()
            if count > SHOWN_PER_RULE
        }


class Violations:
    """Collects violations while the rules are checked, and writes times in the task's unit.

    Carried violations are counted apart, so that they never crowd out the others.
    """

    def __init__(self, time_unit: str) -> None:
        self.time_unit = time_unit
        self._found = _Collection()
        self._carried = _Collection()

    def add(
        self,
        rule: str,
        message: str,
        actions: Iterable[str] = (),
        times: Iterable[Number] = (),
        *,
        carried: bool = False,
    ) -> None:
        """Records a violation; `actions` and `times` are read only if it will be reported."""
        collection = self._carried if carried else self._found
        collection.count[rule] += 1
        if collection.count[rule] <= SHOWN_PER_RULE:
            distinct = tuple(dict.fromkeys(actions))
            collection.shown.append(Violation(rule, RULES[rule], message, distinct, tuple(times)))

    def merge(self, other: Violations) -> None:
        """Adds all violations of `other`."""
        self._found.merge(other._found)
        self._carried.merge(other._carried)

    def time(self, value: Number) -> str:
        """ "3 s": a time with the task's unit."""
        return f"{format_number(value)} {self.time_unit}"

    def __bool__(self) -> bool:
        """Whether anything is wrong, carried or not."""
        return bool(self._found.count or self._carried.count)

    @property
    def only_undecided(self) -> bool:
        """Whether the only finding is that a search gave up."""
        return set(self._found.count) == {"undecided"}

    @property
    def found(self) -> tuple[Violation, ...]:
        """All violations to report, by the number of the rule; those without a number last."""
        return self._found.in_order

    @property
    def omitted(self) -> dict[str, int]:
        """The number of violations of each rule that are not reported."""
        return self._found.omitted

    @property
    def carried(self) -> tuple[Violation, ...]:
        """Like `found`, for carried violations."""
        return self._carried.in_order

    @property
    def carried_omitted(self) -> dict[str, int]:
        """Like `omitted`, for carried violations."""
        return self._carried.omitted


def listed(names: Iterable[str], count: int) -> str:
    """ "'a', 'b' and 7 more": the first few of `count` names."""
    return and_more([repr(name) for name in islice(names, _NAMED_IN_A_MESSAGE)], count)
