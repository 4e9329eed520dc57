"""The rules of the Robo kitchen: the possible processing of an item, and the steps to a state.

Each process changes an item from one state to another, so the steps to a wanted state are found
from its end: one process gives a state, and it starts from one state. Other processing is not
needed and could only make a schedule longer.
"""

from __future__ import annotations

from dataclasses import dataclass

from irc.errors import IrcError
from irc.model.quantities import Span

STACK = "stack"
"""Puts an item on the dish; needs no station."""


@dataclass(frozen=True)
class Process:
    """A kind of processing: the state that it gives an item, and its station."""

    action: str
    result: str
    station: str


PROCESSES = (
    Process("grill", "grilled", "grill"),
    Process("cut", "cut", "cutting_board"),
    Process("fry", "fried", "fryer"),
    Process("boil", "boiled", "boiler"),
    Process("toast", "toasted", "toaster"),
    Process("marinate", "marinated", "marinator"),
    Process("mash", "mashed", "cutting_board"),
)
STATIONS = tuple(dict.fromkeys(process.station for process in PROCESSES))
ACTIONS = (*(process.action for process in PROCESSES), STACK)
STATES = ("raw", "ready", *(process.result for process in PROCESSES))
PREDICATES = (
    "iscookable",
    "iscookableifmarinated",
    "iscuttable",
    "isfryable",
    "isfryableifcut",
    "isboilable",
    "ismarinatable",
)
_MAKES = {process.result: process for process in PROCESSES}


@dataclass(frozen=True)
class Item:
    """An ingredient: its first state, its possible processing, and the conditions of that."""

    name: str
    state: str
    predicates: frozenset[str] = frozenset()
    grill_requires_marinated: bool = False
    fry_requires_cut: bool = False
    mash_requires_boiled: bool = False
    """Given for items to be mashed; only boiled items can be mashed in any case."""


@dataclass(frozen=True)
class Kitchen:
    """The kitchen: durations by action, capacities by station, and the robots."""

    durations: dict[str, Span]
    stations: dict[str, int]
    robots: tuple[str, ...] = ()


@dataclass(frozen=True)
class ProcessingStep:
    """One processing of one item, which changes it from the state `before` to `after`."""

    action: str
    item: str
    station: str
    before: str
    after: str


class UnreachableError(IrcError, ValueError):
    """No processing leads an item to the wanted state; the message says why."""


def action_id(action: str, item: str) -> str:
    """The id of an action: `<action>_<item>`, as in other pipelines for this benchmark."""
    return f"{action}_{item}"


def steps_to(item: Item, wanted: str) -> tuple[ProcessingStep, ...]:
    """The processing that leads an item to a state, in order; empty if it has the state already.

    Raises `UnreachableError`.
    """
    steps: list[ProcessingStep] = []
    state = wanted
    while state != item.state:
        process = _MAKES.get(state)
        before = None if process is None else _starts_from(process.action, item)
        if process is None or before is None:
            raise UnreachableError(_why_not(item, wanted, state, process))
        steps.append(ProcessingStep(process.action, item.name, process.station, before, state))
        state = before
    return tuple(reversed(steps))


def states_of(item: Item) -> tuple[str, ...]:
    """Every state that the item can reach, its first one at the beginning."""
    found = dict.fromkeys([item.state])
    while True:
        more = {
            process.result
            for process in PROCESSES
            if process.result not in found and _starts_from(process.action, item) in found
        }
        if not more:
            return tuple(found)
        found.update((process.result, None) for process in PROCESSES if process.result in more)


def _starts_from(action: str, item: Item) -> str | None:
    """The state in which a process may start; None if the item does not allow the process."""
    has = item.predicates
    if action == "grill":
        if item.grill_requires_marinated:
            return "marinated"
        if "iscookable" in has:
            return "raw"
        return "marinated" if "iscookableifmarinated" in has else None
    if action == "fry":
        if item.fry_requires_cut:
            return "cut"
        if "isfryable" in has:
            return "raw"
        return "cut" if "isfryableifcut" in has else None
    if action in ("mash", "toast"):  # The benchmark has no predicates for these.
        return "boiled" if action == "mash" else "raw"
    needed, before = {
        "cut": ("iscuttable", "raw"),
        "marinate": ("ismarinatable", "cut"),
        "boil": ("isboilable", "raw"),
    }[action]
    return before if needed in has else None


def _why_not(item: Item, wanted: str, state: str, process: Process | None) -> str:
    predicates = ", ".join(sorted(item.predicates)) or "none"
    if process is None:
        reason = f"no action makes anything {state!r}"
    else:
        reason = f"it cannot be {state}: its predicates are {predicates}"
    via = "" if state == wanted else f" by way of {state!r}"
    return (
        f"item {item.name!r} cannot become {wanted!r}{via} from its state {item.state!r}; {reason}"
    )
