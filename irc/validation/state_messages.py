"""The messages of violations of rules 6 and 7."""

from __future__ import annotations

from collections.abc import Sequence

from irc.model.state_values import value_text
from irc.validation.happenings import Hold, Read, Write, moment_text
from irc.validation.levels import (
    Between,
    Need,
    Value,
    change_text,
    need_text,
    stay_text,
)
from irc.validation.verdict import Violations, listed


def add_unmet(
    variable: str, access: Read, found: str, violations: Violations, *, carried: bool = False
) -> None:
    """Reports a condition that does not hold just before its happening."""
    happening = access.happening
    violations.add(
        "state",
        f"{happening.occurrence.name} needs {need_text(variable, access.need)} just before "
        f"{moment_text(happening, violations.time(happening.time))}, but it is {found}",
        [happening.occurrence.entry.id],
        (happening.time,),
        carried=carried,
    )


def add_unheld(
    variable: str, hold: Hold, found: str, violations: Violations, *, carried: bool = False
) -> None:
    """Reports a condition on the whole duration that does not hold when it begins."""
    occurrence = hold.opening.occurrence
    violations.add(
        "state",
        f"{occurrence.name} needs {need_text(variable, hold.need)} while it lasts "
        f"({violations.time(hold.opening.time)} to {violations.time(hold.closing.time)}), "
        f"but just after its start it is {found}",
        [occurrence.entry.id],
        (hold.opening.time, hold.closing.time),
        carried=carried,
    )


def add_broken(
    variable: str,
    access: Write,
    broken: Sequence[Hold],
    violations: Violations,
    *,
    carried: bool = False,
) -> None:
    """Reports a change of a value that others need unchanged while they last."""
    happening = access.happening
    names = [hold.opening.occurrence.entry.id for hold in broken]
    violations.add(
        "state",
        f"{happening.occurrence.name} {change_text(variable, access.change)} at "
        f"{violations.time(happening.time)}, while {listed(names, len(names))} "
        f"{'needs' if len(names) == 1 else 'need'} it to stay "
        f"{stay_text(broken[0].need)}",
        [happening.occurrence.entry.id, *names],
        (happening.time,),
        carried=carried,
    )


def add_contradiction(
    variable: str, access: Write, violations: Violations, *, carried: bool = False
) -> None:
    """Reports a happening that gives a variable two values."""
    happening = access.happening
    violations.add(
        "state",
        f"{happening.occurrence.name} gives {variable!r} two values at once, at "
        f"{moment_text(happening, violations.time(happening.time))}",
        [happening.occurrence.entry.id],
        (happening.time,),
        carried=carried,
    )


def add_out_of_bounds(
    variable: str,
    access: Write,
    value: Value,
    bounds: Between,
    violations: Violations,
    *,
    carried: bool = False,
) -> None:
    """Reports a number that leaves its bounds."""
    happening = access.happening
    violations.add(
        "bounds",
        f"{happening.occurrence.name} {change_text(variable, access.change)} at "
        f"{violations.time(happening.time)}, which makes it {value_text(value)}; it stays "
        f"{stay_text(bounds)}",
        [happening.occurrence.entry.id],
        (happening.time,),
        carried=carried,
    )


def add_unmet_goal(variable: str, wanted: Need, found: Value, violations: Violations) -> None:
    """Reports a goal that does not hold when everything has ended."""
    violations.add(
        "goal",
        f"the goal {need_text(variable, wanted)} does not hold at the end: "
        f"it is {value_text(found)}",
    )
