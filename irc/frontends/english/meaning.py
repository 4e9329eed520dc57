"""A derivation → the statements it makes. Each rule of the grammar has one function here."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, cast

from lark import Token

from irc.errors import IrcError
from irc.frontends.english.parsing import Derivation
from irc.frontends.english.statements import (
    Apart,
    AtATime,
    Begins,
    Between,
    Chain,
    Changes,
    Deadline,
    Due,
    EachAfterPrevious,
    Frame,
    Free,
    Length,
    MayPause,
    OpenTimes,
    Ordering,
    OthersAfter,
    Place,
    Point,
    Ref,
    Refs,
    Refused,
    Selects,
    Statement,
    StoryPart,
    Takes,
    UsesTheSame,
    UsesThing,
)
from irc.frontends.english.units import UNITS, unit_size
from irc.frontends.english.words import Word
from irc.model.quantities import exact
from irc.model.times import format_number

_VALUED = frozenset(
    [
        *("NUM", "NUMS", "LABEL", "NAME", "QUOTE", "UNIT", "FREE", "ONE", "ORDINAL"),
        *("THING", "CLOCK", "DATE", "DAY"),
    ]
)
_ORDINALS = ["second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"]


class Inexact(IrcError):
    """A part of a sentence that is not exact; the message is a key of `REASONS`."""


def meaning(derivation: Derivation, words: Sequence[Word]) -> tuple[Statement, ...]:
    """The statements of a derivation. Raises `Inexact`."""
    return _flat(_value(derivation, words))


def _value(node: Derivation | Token, words: Sequence[Word]) -> Any:
    if isinstance(node, Token):
        return words[node.start_pos or 0]
    values = [
        _value(child, words)
        for child in node.children
        if not isinstance(child, Token) or child.type in _VALUED
    ]
    name = str(node.data)
    if name.startswith("refused_"):
        return Refused(name.removeprefix("refused_"))
    return _RULES[name](values, _Place(node, words))


class _Place:
    """Where a derivation stands: its first and last word, and what kinds of words it has."""

    def __init__(self, node: Derivation, words: Sequence[Word]) -> None:
        self._node = node
        self._words = words

    def has(self, *kinds: str) -> bool:
        """Whether the rule itself took a word of one of these kinds."""
        return any(isinstance(c, Token) and c.type in kinds for c in self._node.children)

    @property
    def range(self) -> tuple[int, int]:
        """[start, end) in the text."""
        first: Derivation | Token = self._node
        last: Derivation | Token = self._node
        while not isinstance(first, Token):
            first = first.children[0]
        while not isinstance(last, Token):
            last = last.children[-1]
        return self._words[first.start_pos or 0].start, self._words[last.start_pos or 0].end


def _flat(value: Any) -> tuple[Any, ...]:
    if isinstance(value, (list, tuple)):
        return tuple(item for part in value for item in _flat(part))
    return () if value is None else (value,)


# References


def _number_of(value: Any) -> Any:
    """The label that a number word or a label gives: an int, or a text."""
    if isinstance(value, Word):
        if value.kind == "LABEL":
            return str(value.value)
        if value.kind == "ONE":
            return 1
        number = cast(Fraction, value.value)
        if number.denominator != 1 or "," in value.text:
            raise Inexact("label")
        return number.numerator
    return value


def _number(values: list[Any], place: _Place) -> Ref:
    start, end = place.range
    return Ref("label", (_number_of(values[0]),), start, end)


def _ref(values: list[Any], place: _Place) -> Any:
    (inner,) = values
    if isinstance(inner, tuple):
        return inner
    start, end = place.range
    return Ref(inner.kind, inner.value, start, end)


def _number_range(values: list[Any], place: _Place) -> Ref:
    start, end = place.range
    return Ref("range", (values[0].value[0], values[1].value[0]), start, end)


def _long_list(values: list[Any], _place: _Place) -> tuple[Ref, ...]:
    members = cast(tuple[Word, ...], values[0].value)
    return tuple(Ref("label", (_number_of(m),), m.start, m.end) for m in members)


def _name(values: list[Any], place: _Place) -> Ref:
    start, end = place.range
    return Ref("name", (values[0].value,), start, end)


def _ordinal(values: list[Any], place: _Place) -> Ref:
    start, end = place.range
    return Ref("nth", (_ORDINALS.index(values[0].text.lower()) + 2,), start, end)


def _special(kind: str) -> Callable[[list[Any], _Place], Ref]:
    def make(_values: list[Any], place: _Place) -> Ref:
        return Ref(kind, (), *place.range)

    return make


def _refs(values: list[Any], _place: _Place) -> Refs:
    return _flat(values)


# Times


def _quantity(values: list[Any], _place: _Place) -> tuple[Fraction, str]:
    return values[0], values[1].value


def _length(parts: Sequence[tuple[Fraction, str]]) -> Length:
    seconds, months, texts = Fraction(0), Fraction(0), []
    sizes = []
    for amount, written in parts:
        count, unit = UNITS[written]
        size, size_in_months = unit_size(unit)
        seconds += amount * count * size
        months += amount * count * size_in_months
        texts.append(f"{format_number(exact(amount * count))} {unit}")
        sizes.append(size + size_in_months * 30 * 86_400)
    if any(later >= earlier for earlier, later in itertools.pairwise(sizes)):
        raise Inexact("units")
    return Length(" ".join(texts), seconds, months, UNITS[parts[-1][1]][1])


def _span(values: list[Any], _place: _Place) -> Length:
    return _length(values)


def _between(values: list[Any], _place: _Place) -> Between:
    least, most = values
    if least.seconds + least.months * 31 * 86_400 > most.seconds + most.months * 31 * 86_400:
        raise Inexact("range")
    return Between(least, most)


def _amounts(values: list[Any], place: _Place) -> Between:
    low, high, unit = values
    return _between([_length([(low, unit.value)]), _length([(high, unit.value)])], place)


def _plus_half(values: list[Any], _place: _Place) -> Length:
    *counted, unit = values
    amount = counted[0].value if counted and counted[0].kind == "NUM" else Fraction(1)
    return _length([(amount + Fraction(1, 2), unit.value)])


def _amount(value: Fraction | None, added: Fraction = Fraction(0)) -> Callable[..., Fraction]:
    def make(values: list[Any], _place: _Place) -> Fraction:
        return (values[0].value if value is None else value) + added

    return make


def _quarters(values: list[Any], _place: _Place) -> Fraction:
    return cast(Fraction, values[0].value) / 4


# Points


def _point(edge: str) -> Callable[[list[Any], _Place], Point]:
    def make(values: list[Any], _place: _Place) -> Point:
        return Point(values[0], "start" if edge == "start" else "end")

    return make


# Ordering


def _start(refs: Refs) -> Point:
    return Point(refs, "start")


def _end(refs: Refs) -> Point:
    return Point(refs, "end")


def _without_when(values: list[Any]) -> list[Any]:
    return [v for v in values if v is not None]


def _precedes(values: list[Any], _place: _Place) -> Ordering:
    return Ordering(_end(values[0]), _start(values[1]))


def _follows(values: list[Any], _place: _Place) -> Ordering:
    return Ordering(_end(values[1]), _start(values[0]))


def _before(edge: Callable[[Refs], Point]) -> Callable[[list[Any], _Place], Ordering]:
    def make(values: list[Any], _place: _Place) -> Ordering:
        return Ordering(edge(values[0]), values[1])

    return make


def _after(edge: Callable[[Refs], Point]) -> Callable[[list[Any], _Place], Ordering]:
    def make(values: list[Any], _place: _Place) -> Ordering:
        refs, point = _without_when(values)
        return Ordering(point, edge(refs))

    return make


def _after_and_before(values: list[Any], _place: _Place) -> list[Ordering]:
    refs, after, before = values
    return [Ordering(after, _start(refs)), Ordering(_end(refs), before)]


def _before_and_after(values: list[Any], place: _Place) -> list[Ordering]:
    refs, before, after = values
    return _after_and_before([refs, after, before], place)


def _in_between(values: list[Any], _place: _Place) -> list[Ordering]:
    refs, first, second = values
    return [Ordering(_end((first,)), _start(refs)), Ordering(_end(refs), _start((second,)))]


def _front_after(values: list[Any], _place: _Place) -> Ordering:
    point, refs = _without_when(values)
    return Ordering(point, _start(refs))


def _front_before(values: list[Any], _place: _Place) -> Ordering:
    point, refs = values
    return Ordering(_end(refs), point)


def _points(values: list[Any], _place: _Place) -> Ordering:
    before, after = _without_when(values)
    return Ordering(before, after)


def _point_start(values: list[Any], _place: _Place) -> Ordering:
    return Ordering(values[0], _start(values[1]))


# Lags


def _exact_length(time: Any) -> Length:
    if not isinstance(time, Length):
        raise Inexact("lag range")
    return time


_ZERO = Length("0 s", Fraction(0), Fraction(0), "s")


def _lag(least: bool, most: bool) -> Callable[[list[Any], _Place], Ordering]:
    def make(values: list[Any], _place: _Place) -> Ordering:
        refs, time, point = values
        time = _exact_length(time)
        return Ordering(point, _start(refs), time if least else None, time if most else None)

    return make


def _lag_none(values: list[Any], _place: _Place) -> Ordering:
    return Ordering(values[1], _start(values[0]), None, _ZERO)


def _follows_at_once(values: list[Any], _place: _Place) -> Ordering:
    return Ordering(_end(values[1]), _start(values[0]), None, _ZERO)


def _lag_within(values: list[Any], _place: _Place) -> Ordering:
    refs, time, others = values
    return Ordering(_end(others), _start(refs), None, _exact_length(time))


def _lag_between(values: list[Any], place: _Place) -> Ordering:
    time, first, second = values
    time = _exact_length(time)
    least = None if place.has("AT_MOST") else time
    return Ordering(_end(first), _start(second), least, None if place.has("AT_LEAST") else time)


def _lag_wait(values: list[Any], place: _Place) -> Ordering:
    time, after, before = values
    if before.edge != "start":
        raise Inexact("lag_end")
    time = _exact_length(time)
    return Ordering(after, before, time, None if place.has("AT_LEAST") else time)


def _same(edge: Callable[[Refs], Point]) -> Callable[[list[Any], _Place], list[Ordering]]:
    def make(values: list[Any], _place: _Place) -> list[Ordering]:
        members = _flat(values)
        if any(ref.kind.startswith("all") or ref.kind == "range" for ref in members):
            raise Inexact("together")
        if len(members) < 2:
            raise Inexact("alone")
        return [
            Ordering(edge((first,)), edge((second,)), None, _ZERO)
            for first, second in itertools.pairwise(members)
        ]

    return make


# The rest


def _chain(values: list[Any], _place: _Place) -> Chain:
    return Chain(tuple(values))


def _story_part(when: Any) -> Callable[[list[Any], _Place], StoryPart]:
    return lambda values, _place: StoryPart(when, values[0])


def _placed(where: Any) -> Callable[[list[Any], _Place], Place]:
    return lambda values, _place: Place(where, values[0])


def _free(against: Any) -> Callable[[list[Any], _Place], Free]:
    return lambda values, _place: Free(_flat(values), against)


def _frame(kind: Any) -> Callable[[list[Any], _Place], Frame]:
    def make(values: list[Any], _place: _Place) -> Frame:
        free = [v for v in values if isinstance(v, Word) and v.kind == "FREE"]
        return Frame(kind, free[0].text, free[0].start) if free else Frame(kind)

    return make


def _answer_unit(values: list[Any], _place: _Place) -> Frame:
    return Frame("unit", UNITS[values[0].value][1])


def _framed(values: list[Any], _place: _Place) -> list[Frame]:
    return [v for v in values if isinstance(v, Frame)]


def _at_most(values: list[Any], _place: _Place) -> AtATime:
    (most,) = values[0].value
    if not isinstance(most, int) or most < 1:
        raise Inexact("label")
    return AtATime(most)


def _lasts(values: list[Any], place: _Place) -> Takes:
    return Takes(values[0], values[1], place.has("EACH"))


def _each_step_lasts(values: list[Any], place: _Place) -> Takes:
    return Takes((Ref("all", (), *place.range),), values[0], True)


def _this(place: _Place) -> Refs:
    return (Ref("this", (), *place.range),)


def _note_lasts(values: list[Any], place: _Place) -> Takes:
    return Takes(_this(place), values[0], False)


def _note_after(values: list[Any], place: _Place) -> Ordering:
    return Ordering(_without_when(values)[0], _start(_this(place)))


def _note_before(values: list[Any], place: _Place) -> Ordering:
    return Ordering(_end(_this(place)), values[0])


def _note_needs(values: list[Any], place: _Place) -> Ordering:
    return Ordering(_end(values[0]), _start(_this(place)))


def _note_precedes(values: list[Any], place: _Place) -> Ordering:
    return Ordering(_end(_this(place)), _start(values[0]))


# Which steps are done, and what they use


def _count(values: list[Any], _place: _Place) -> int:
    number = _number_of(values[0])
    if not isinstance(number, int):
        raise Inexact("label")
    return number


def _exactly_one(values: list[Any], _place: _Place) -> Selects:
    return Selects(_flat(values), 1, 1)


def _selects(least: bool, most: bool) -> Callable[[list[Any], _Place], Selects]:
    def make(values: list[Any], _place: _Place) -> Selects:
        count = next(v for v in values if isinstance(v, int))
        refs = next(v for v in values if isinstance(v, tuple))
        return Selects(refs, count if least else 0, count if most else None)

    return make


def _uses(values: list[Any], _place: _Place) -> UsesThing:
    refs, thing, *family = values
    return UsesThing(refs, (thing.text,), family[0].text if family else None)


def _uses_one_of(values: list[Any], place: _Place) -> UsesThing:
    refs = values[0]
    things = tuple(v.text for v in values if isinstance(v, Word) and v.kind == "THING")
    return UsesThing(refs, things)


def _uses_the_same(values: list[Any], _place: _Place) -> UsesTheSame:
    thing = next(v for v in values if isinstance(v, Word))
    refs, *others = (v for v in values if isinstance(v, tuple))
    return UsesTheSame(refs, thing.text, *others)


def _hour(values: list[Any], _place: _Place) -> str:
    word = values[0]
    if word.kind == "CLOCK":
        return str(word.value)
    hour = _number_of(word)
    if not isinstance(hour, int) or not 0 <= hour <= _LAST_HOUR:
        raise Inexact("hour")
    return f"{hour:02}:00"


_LAST_HOUR = 24


def _days(values: list[Any], _place: _Place) -> tuple[str, ...]:
    return ("days", *(word.text.lower()[:3] for word in values))


def _hours(values: list[Any], _place: _Place) -> OpenTimes:
    begin, end = (v for v in values if isinstance(v, str))
    days = next((v[1:] for v in values if isinstance(v, tuple)), ())
    return OpenTimes(None, begin, end, days)


def _days_off(values: list[Any], _place: _Place) -> OpenTimes:
    return OpenTimes(None, "00:00", "24:00", values[0][1:])


def _dates(values: list[Any], _place: _Place) -> OpenTimes:
    return OpenTimes(None, "00:00", "24:00", dates=tuple(str(word.value) for word in values))


def _times(closed: bool) -> Callable[[list[Any], _Place], OpenTimes]:
    def make(values: list[Any], _place: _Place) -> OpenTimes:
        *thing, spoken = values
        times = cast(OpenTimes, spoken)
        return replace(times, thing=thing[0].text if thing else None, closed=closed)

    return make


def _uses_amount(values: list[Any], _place: _Place) -> UsesThing:
    refs, amount, number, thing = values
    capacity = _number_of(number)
    if not isinstance(capacity, int) or not 1 <= amount <= capacity:
        raise Inexact("amount")
    return UsesThing(refs, (thing.text,), amount=amount, capacity=capacity)


def _changes(values: list[Any], _place: _Place) -> Changes:
    thing, before, after, time = values
    return Changes(thing.text, before.text, after.text, _exact_length(time))


def _begins(values: list[Any], _place: _Place) -> Begins:
    date, *clock = values
    return Begins(f"{date.value}T{clock[0].value if clock else '00:00'}:00")


def _as_is(values: list[Any], _place: _Place) -> Any:
    return values


def _only(values: list[Any], _place: _Place) -> Any:
    return values[0]


def _nothing(_values: list[Any], _place: _Place) -> None:
    return None


_RULES: Mapping[str, Callable[[list[Any], _Place], Any]] = {
    "sentence": _as_is,
    "opener": _nothing,
    "note": _as_is,
    "note_part": _as_is,
    "story": _as_is,
    "field": _as_is,
    "when": _nothing,
    # references
    "refs": _refs,
    "nor_refs": _refs,
    "ref": _ref,
    "number": _number,
    "number_range": _number_range,
    "long_list": _long_list,
    "name": _name,
    "ordinal": _ordinal,
    "this_step": _special("this"),
    "first_step": _special("first"),
    "last_step": _special("last"),
    "previous_step": _special("previous"),
    "all_previous": _special("all_previous"),
    "all_other": _special("all_other"),
    "all_steps": _special("all"),
    # times
    "quantity": _quantity,
    "span": _span,
    "spans": _between,
    "amounts": _amounts,
    "unit_and_a_half": _plus_half,
    "units_and_a_half": _plus_half,
    "number_amount": _amount(None),
    "one_amount": _amount(Fraction(1)),
    "half_amount": _amount(Fraction(1, 2)),
    "number_and_a_half": _amount(None, Fraction(1, 2)),
    "one_and_a_half": _amount(Fraction(3, 2)),
    "quarter_amount": _amount(Fraction(1, 4)),
    "quarters_amount": _quarters,
    # points
    "to_start": _point("start"),
    "to_end": _point("end"),
    "from_start": _point("start"),
    "from_end": _point("end"),
    # order
    "precedes": _precedes,
    "follows": _follows,
    "starts_after": _after(_start),
    "ends_after": _after(_end),
    "ends_before": _before(_end),
    "starts_before": _before(_start),
    "after_and_before": _after_and_before,
    "before_and_after": _before_and_after,
    "between": _in_between,
    "others_after": lambda values, _place: OthersAfter(values[0]),
    "point_before": _points,
    "point_start": _point_start,
    "front_after": _front_after,
    "front_before": _front_before,
    "comes_first": _placed("first"),
    "comes_last": _placed("last"),
    "in_order": _placed("in order"),
    "each_after_previous": lambda _values, _place: EachAfterPrevious(),
    # lags
    "lag_at_least": _lag(True, False),
    "lag_at_most": _lag(False, True),
    "lag_exactly": _lag(True, True),
    "lag_none": _lag_none,
    "follows_at_once": _follows_at_once,
    "lag_within": _lag_within,
    "lag_between": _lag_between,
    "lag_wait": _lag_wait,
    "same_start": _same(_start),
    "same_end": _same(_end),
    # sequences
    "chain": _chain,
    "opens": _story_part("first"),
    "continues": _story_part("then"),
    "concludes": _story_part("finally"),
    # freedom and limits
    "free": _free("each other"),
    "unconstrained": _free("all"),
    "no_orders": _frame("no orders"),
    "all_free": _frame("plain"),
    "one_at_a_time": lambda _values, _place: AtATime(1),
    "some_at_a_time": _at_most,
    "apart": lambda values, _place: Apart(values[0]),
    "apart_pair": lambda values, _place: Apart(values[0], pair=True),
    "apart_from": lambda values, _place: Apart(values[0], values[1]),
    "deadline": lambda values, _place: Deadline(_exact_length(values[-1])),
    # which steps are done, and what they use
    "count": _count,
    "exactly_one": _exactly_one,
    "exactly": _selects(True, True),
    "at_least": _selects(True, False),
    "at_most": _selects(False, True),
    "all_or_none": lambda values, _place: Selects(values[-1], all_or_none=True),
    "due": lambda values, _place: Due(values[0], _exact_length(values[1])),
    "uses": _uses,
    "uses_one_of": _uses_one_of,
    "uses_the_same": _uses_the_same,
    "share_the_same": _uses_the_same,
    "hour": _hour,
    "weekdays": lambda _values, _place: ("days", "mon", "tue", "wed", "thu", "fri"),
    "some_days": _days,
    "uses_amount": _uses_amount,
    "hours": _hours,
    "days_off": _days_off,
    "dates": _dates,
    "open_times": _times(False),
    "closed_times": _times(True),
    "changes": _changes,
    "pauses": lambda values, _place: MayPause(values[0]),
    "begins": _begins,
    # durations
    "lasts": _lasts,
    "lasts_each": lambda values, _place: Takes(values[0], values[1], True),
    "each_step_lasts": _each_step_lasts,
    "it_takes": lambda values, _place: Takes(values[1], values[0], False),
    "note_lasts": _note_lasts,
    "note_after": _note_after,
    "note_before": _note_before,
    "note_needs": _note_needs,
    "note_precedes": _note_precedes,
    "note_nothing": _nothing,
    # the frame
    "plain": _frame("plain"),
    "titled": _frame("titled"),
    "only_orders": _frame("orders"),
    "framed": _framed,
    "all_needed": _frame("all needed"),
    "unbounded": _frame("unbounded"),
    "answer_unit": _answer_unit,
}
