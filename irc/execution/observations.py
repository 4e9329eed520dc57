"""The observed facts about each occurrence, and which of two observations counts.

An observation says one or more of three facts: whether (and when) an occurrence began, whether (and
when) it ended, and how it is done. Where two observations contradict each other in a fact, the
later one counts: the one of the later event, and of one instant the one that came in last.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from irc.model.events import Observe
from irc.model.quantities import Number
from irc.model.times import Clock, format_number

NOT_BEGUN, STARTED, RUNNING, ENDED, FAILED = "not begun", "started", "running", "ended", "failed"


@dataclass(frozen=True, slots=True)
class Fact:
    """One fact about an occurrence: `what` at `time`, said by the event at `at`.

    `number` is the place of that event among all that came in. A fact that it runs may have the
    time at which it is `expected` to end, `as_planned` or not. A fact on how it is done has `mode`
    and `resources` (the names in the observation), and no `what`.
    """

    at: Number
    number: int
    what: str = ""
    time: Number = 0
    expected: Number | None = None
    as_planned: bool = False
    mode: str | None = None
    resources: tuple[str, ...] = ()

    @property
    def order(self) -> tuple[Number, int]:
        """Later facts have a greater one."""
        return self.at, self.number

    def in_words(self, unit: str) -> str:
        """The fact, as the rest of a sentence that begins with the action's name."""
        if not self.what:
            how = [f"as {self.mode!r}"] if self.mode is not None else []
            how += [f"by {', '.join(map(repr, self.resources))}"] if self.resources else []
            return f"is done {' '.join(how)}"
        words = {
            NOT_BEGUN: "had not begun",
            STARTED: "started",
            RUNNING: "was running",
            ENDED: "finished",
            FAILED: "failed",
        }
        return f"{words[self.what]} at {format_number(self.time)} {unit}"


@dataclass(frozen=True, slots=True)
class Observed:
    """All facts that have been observed of one occurrence, in their order, and those that count.

    A fact counts unless a later one that counts contradicts it, in whatever order they come in.
    """

    facts: tuple[Fact, ...] = ()
    begin: Fact | None = field(init=False)
    """When it started, or that it had not begun."""
    end: Fact | None = field(init=False)
    """When it ended or failed, or that it was still running."""
    way: Fact | None = field(init=False)
    """The mode and the resources."""

    def __post_init__(self) -> None:
        counting = self.counting
        for name, whats in (("begin", (STARTED, NOT_BEGUN)), ("end", (ENDED, FAILED, RUNNING))):
            its = [f for f in counting if f.what in whats]
            # (That it started, or ended, says more than that it had not.)
            best = [f for f in its if f.what not in (NOT_BEGUN, RUNNING)] or its
            object.__setattr__(self, name, best[0] if best else None)
        way: Fact | None = None
        for fact in reversed([f for f in counting if not f.what]):
            way = _joined(way, fact)
        object.__setattr__(self, "way", way)

    @property
    def counting(self) -> list[Fact]:
        """The facts that count, the latest first.

        An executive may report the same at every tick, so this takes time linear in their number:
        whether a fact contradicts those of one kind is decided by their first and last times.
        """
        found: list[Fact] = []
        extremes: dict[object, tuple[Fact, Fact]] = {}
        for fact in reversed(self.facts):
            if any(contradicts(fact, later) for pair in extremes.values() for later in pair):
                continue
            found.append(fact)
            kind = fact.what or (fact.mode, fact.resources)
            first, last = extremes.get(kind, (fact, fact))
            first = fact if fact.time < first.time else first
            extremes[kind] = first, fact if fact.time > last.time else last
        return found

    @property
    def waits(self) -> bool:
        """Whether the last that is known is that it has not begun."""
        begun = self.end is not None or self.way is not None
        return self.begin is not None and self.begin.what == NOT_BEGUN and not begun

    @property
    def has_begun(self) -> bool:
        """Whether it was observed to have begun."""
        return not self.waits and (self.begin or self.end or self.way) is not None

    @property
    def started(self) -> Number | None:
        """When it was observed to start."""
        return self.begin.time if self.begin is not None and self.begin.what == STARTED else None

    @property
    def ended(self) -> Number | None:
        """When it was observed to end, done or failed."""
        over = self.end is not None and self.end.what in (ENDED, FAILED)
        return self.end.time if over and self.end is not None else None

    @property
    def failed(self) -> bool:
        """Whether it was observed to fail."""
        return self.end is not None and self.end.what == FAILED


def facts_of(change: Observe, at: Number, number: int, clock: Clock) -> Iterator[Fact]:
    """The facts that an observation by an event at `at` says."""

    def time(value: object, otherwise: Number = 0) -> Number:
        return otherwise if value is None else clock.number(value)  # type: ignore[arg-type]

    if change.status == "not_begun":
        yield Fact(at, number, NOT_BEGUN, at)
        return
    if change.started is not None:
        yield Fact(at, number, STARTED, time(change.started))
    if change.status in ("finished", "failed") or change.finished is not None:
        what = FAILED if change.status == "failed" else ENDED
        yield Fact(at, number, what, time(change.finished, at))
    elif change.status == "running" or change.expected_end is not None:
        expected = None if change.expected_end is None else time(change.expected_end)
        yield Fact(at, number, RUNNING, at, expected)
    if change.mode is not None or change.resources:
        yield Fact(at, number, mode=change.mode, resources=change.resources)


def contradicts(earlier: Fact, later: Fact) -> bool:
    """Whether two facts about one occurrence cannot both be so; `later` was observed later."""
    if not earlier.what or not later.what:
        return earlier.what == later.what and not _same_way(earlier, later)
    pair = earlier.what, later.what
    if later.what == NOT_BEGUN:
        return earlier.what != NOT_BEGUN and earlier.time <= later.time
    if earlier.what == NOT_BEGUN:
        return later.time < earlier.time
    if pair == (RUNNING, RUNNING):
        return False
    if STARTED in pair and pair != (STARTED, STARTED):
        start, other = (earlier, later) if earlier.what == STARTED else (later, earlier)
        return start.time > other.time
    if later.what == RUNNING:
        return earlier.time <= later.time
    if earlier.what == RUNNING:
        return later.time < earlier.time
    return pair[0] != pair[1] or earlier.time != later.time


def _same_way(earlier: Fact, later: Fact) -> bool:
    same_mode = later.mode in (None, earlier.mode) or earlier.mode is None
    same = not earlier.resources or not later.resources
    return same_mode and (same or sorted(earlier.resources) == sorted(later.resources))


def with_fact(known: Observed, new: Fact) -> tuple[Observed, tuple[Fact, ...], Fact | None]:
    """(all facts with one more, those it corrects, the later one that contradicts it)."""
    before = known.counting
    facts = [f for f in known.facts if not _replaces(new, f)]
    after = Observed(tuple(sorted((*facts, new), key=lambda f: f.order)))
    counting = after.counting
    if new not in counting:
        by = next(f for f in counting if f.order >= new.order and contradicts(new, f))
        return after, (), by
    still = set(counting)
    corrected = [f for f in before if f not in still and contradicts(f, new)]
    return after, tuple(corrected), None


def _replaces(new: Fact, old: Fact) -> bool:
    """Whether an old fact says nothing any more: it ran then, as it does later."""
    return new.what == old.what == RUNNING and old.order < new.order


def _joined(old: Fact | None, new: Fact) -> Fact:
    """A fact on how it is done, with what an earlier one says about the rest."""
    if old is None:
        return new
    return replace(new, mode=new.mode or old.mode, resources=new.resources or old.resources)
