"""What can happen to state within one instant: the orders of its happenings, and what they demand.

Ranks are only ever compared, so a set of demands "rank b ≥ rank a" (0) and "rank b > rank a" (1)
stands for all ranks that keep them. `orders` lists, for the happenings of one instant, each way to
play them in layers (a layer is one rank), with the values that come out and the demands on the
ranks of those that have to do with each other. Happenings that commute are put in the earliest
layer that gives the same meaning (the normal form of Foata), so each way is listed once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, combinations, permutations, product

from oracles.state_task import Fact, Given, Job, Value, become, suits, together

Values = tuple[tuple[str, Value], ...]
Demand = tuple[int, int, int]
"""(a, b, least): the rank of node b is at least that of node a (plus 1)."""

Outcome = tuple[Values, frozenset[Demand]]


@dataclass(frozen=True)
class Happening:
    """A start, an end, or both at once. `node` stands for its rank.

    `follows` names the start that a drawn-out end must come after, at a later rank.
    """

    node: int
    reads: frozenset[Fact] = frozenset()
    writes: frozenset[tuple[str, Given]] = frozenset()
    opens: frozenset[Fact] = frozenset()
    closes: frozenset[Fact] = frozenset()
    follows: int | None = None

    @property
    def contradicts_itself(self) -> bool:
        """Whether it gives one variable two values."""
        return len({var for var, _ in self.writes}) < len(self.writes)


def happening_at_start(job: Job, node: int) -> Happening:
    """The start of an occurrence that ends later, or at a later rank."""
    return Happening(
        node,
        reads=_conditions(job, "start"),
        writes=_effects(job, "start"),
        opens=_conditions(job, "all"),
    )


def happening_at_end(job: Job, node: int, follows: int | None = None) -> Happening:
    """The end of an occurrence that started earlier, or at an earlier rank."""
    return Happening(
        node,
        reads=_conditions(job, "end"),
        writes=_effects(job, "end"),
        closes=_conditions(job, "all"),
        follows=follows,
    )


def whole_happening(job: Job, node: int) -> Happening:
    """An occurrence that takes no time: all conditions just before, all effects at it."""
    return Happening(
        node,
        reads=_conditions(job, "start", "all", "end"),
        writes=_effects(job, "start", "end"),
    )


def _conditions(job: Job, *places: str) -> frozenset[Fact]:
    return frozenset((var, value) for at, var, value in job.conditions if at in places)


def _effects(job: Job, *places: str) -> frozenset[tuple[str, Given]]:
    return together((var, given) for at, var, given in job.effects if at in places)


def interfere(one: Happening, two: Happening) -> bool:
    """Whether one changes a variable that the other reads or changes."""
    return _meets(one.writes, (*two.reads, *two.writes)) or _meets(two.writes, one.reads)


def _meets(facts: Iterable[tuple[str, object]], others: Iterable[tuple[str, object]]) -> bool:
    return not {var for var, _ in facts}.isdisjoint(var for var, _ in others)


def demand(earlier: Happening, later: Happening, *, same: bool) -> Demand | None:
    """What the ranks must keep so that two happenings mean what their layers say.

    A hold looks at the value just after its opening and up to just before its closing, so a change
    at the very rank of the opening counts, and one at the very rank of the closing does not.
    """
    strict = (
        interfere(earlier, later)
        or later.follows == earlier.node
        or _meets(earlier.opens, later.writes)
        or _meets(earlier.writes, later.closes)
    )
    if strict and not same:
        return earlier.node, later.node, 1
    if _meets(earlier.writes, later.opens) or _meets(earlier.closes, later.writes):
        return earlier.node, later.node, 0
    return None


def orders(values: Values, held: frozenset[Fact], happenings: Sequence[Happening]) -> list[Outcome]:
    """All ways to play one instant; `held` must hold throughout. Dominated ways are left out."""
    found: set[Outcome] = set()
    if not any(h.contradicts_itself for h in happenings):
        play = _Play(held, happenings)
        for layers, final in play.play(dict(values)):
            demands = frozenset(play.demands(layers))
            found.add((tuple(sorted(final.items())), demands))
    return [
        (outcome, demands)
        for outcome, demands in found
        if not any(o == outcome and d < demands for o, d in found)
    ]


@dataclass
class _Play:
    held: frozenset[Fact]
    happenings: Sequence[Happening]
    layers: list[tuple[Happening, ...]] = field(default_factory=list)

    def __post_init__(self) -> None:
        pairs = list(permutations(self.happenings, 2))
        self.clashing = {(a.node, b.node) for a, b in pairs if interfere(a, b)}
        self.apart = {(a.node, b.node): demand(a, b, same=False) for a, b in pairs}
        self.together = {(a.node, b.node): demand(a, b, same=True) for a, b in pairs}

    def demands(self, layers: Sequence[Sequence[Happening]]) -> Iterator[Demand]:
        """What the ranks must keep for these layers."""
        for i, layer in enumerate(layers):
            for one, two in permutations(layer, 2):
                needed = self.together[one.node, two.node]
                if needed is not None:
                    yield needed
            for one, two in product(layer, chain.from_iterable(layers[i + 1 :])):
                needed = self.apart[one.node, two.node]
                if needed is not None:
                    yield needed

    def play(
        self, values: dict[str, Value]
    ) -> Iterator[tuple[list[tuple[Happening, ...]], dict[str, Value]]]:
        """Each sequence of layers that keeps all conditions, and the last values."""
        # What was opened earlier and closes within this instant is held until then.
        opened = {h.node for h in self.happenings if h.opens}
        holding = [h for h in self.happenings if h.closes and h.follows not in opened]
        yield from self._layers(tuple(self.happenings), values, [h.closes for h in holding])

    def _layers(
        self,
        left: tuple[Happening, ...],
        values: dict[str, Value],
        holds: list[frozenset[Fact]],
    ) -> Iterator[tuple[list[tuple[Happening, ...]], dict[str, Value]]]:
        if not left:
            yield list(self.layers), values
            return
        for size in range(1, len(left) + 1):
            for layer in combinations(left, size):
                after = self._after(layer, left, values, holds)
                if after is None:
                    continue
                self.layers.append(layer)
                rest = tuple(h for h in left if h not in layer)
                yield from self._layers(rest, *after)
                self.layers.pop()

    def _after(
        self,
        layer: tuple[Happening, ...],
        left: tuple[Happening, ...],
        values: dict[str, Value],
        holds: list[frozenset[Fact]],
    ) -> tuple[dict[str, Value], list[frozenset[Fact]]] | None:
        """Values and holds after one more layer; None where something forbids it."""
        if not all(suits(values[var], value) for h in layer for var, value in h.reads):
            return None
        if any(h.follows == other.node for h in layer for other in left if h is not other):
            return None
        if self.layers and not all(self._must_wait(h, layer) for h in layer):
            return None
        if any((one.node, two.node) in self.clashing for one, two in combinations(layer, 2)):
            return None
        following = dict(values)
        for happening in layer:
            following |= {var: become(values[var], given) for var, given in happening.writes}
        still = list(holds)
        for happening in layer:
            if happening.closes:
                still.remove(happening.closes)
            if happening.opens:
                still.append(happening.opens)
        kept = all(
            suits(following[var], value) for facts in (self.held, *still) for var, value in facts
        )
        return (following, still) if kept else None

    def _must_wait(self, happening: Happening, layer: Sequence[Happening]) -> bool:
        """Whether the layer before would change its meaning: for those in it, or for its fellows
        here, without which it would come before what it must not come before."""
        before = (self.apart[other.node, happening.node] for other in self.layers[-1])
        if any(needed is not None and needed[2] == 1 for needed in before):
            return True
        return any(self.together[o.node, happening.node] for o in layer if o is not happening)
