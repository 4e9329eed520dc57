"""The orders of an episode, as they are revealed: what each adds to all that was known before it.

An obligation (an order without a reward) has its actions once. An order with a reward is an
optional group. What an item is to go through is kept in stages, so that a later order can take it
further from where the earlier ones leave it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from irc.frontends.importers.instances import Part
from irc.frontends.importers.robo.document import Lag
from irc.frontends.importers.robo.kitchen import (
    STACK,
    Item,
    Kitchen,
    Step,
    UnreachableError,
    action_id,
    states_of,
    steps_to,
)
from irc.frontends.importers.robo.task import (
    check_lags,
    lags,
    processing,
    stack_order,
    stacking,
    take,
)
from irc.frontends.importers.robo_online.document import Order, Revelation, Wish

Raw = dict[str, Any]


@dataclass
class Additions:
    """What a revelation adds, as parts of an IR document.

    `goals` are all goals from then on, None where they stay as they are. `rewarded` says whether
    some new order has a reward.
    """

    state: list[Raw] = field(default_factory=list)
    actions: list[Raw] = field(default_factory=list)
    precedence: list[Raw] = field(default_factory=list)
    groups: list[Raw] = field(default_factory=list)
    goals: list[Raw | str] | None = None
    rewarded: bool = False


@dataclass
class _Progress:
    """How far orders take an item: its steps, and which of them only a chosen order has."""

    item: Item
    steps: list[Step] = field(default_factory=list)
    chosen: set[str] = field(default_factory=set)
    stacked: bool = False
    declared: bool = False

    @property
    def state(self) -> str:
        """Where the orders so far leave it."""
        return self.steps[-1].after if self.steps else self.item.state

    @property
    def actions(self) -> list[str]:
        """The ids of its processing, in order."""
        return [action_id(step.action, step.item) for step in self.steps]

    def steps_on_to(self, state: str) -> tuple[Step, ...]:
        """What is left to do. Raises `UnreachableError`."""
        if not self.steps:
            return steps_to(self.item, state)
        try:
            return steps_to(replace(self.item, state=self.state), state)
        except UnreachableError:
            raise UnreachableError(
                f"item {self.item.name!r} cannot become {state!r}: an earlier goal takes it to "
                f"{self.state!r}, and no processing leads from there to {state!r}"
            ) from None


@dataclass
class _Draft:
    """An order that is being taken: its new actions, and all that must be done for it.

    `sound` says that all of it could be taken.
    """

    order: Order
    own: list[Raw] = field(default_factory=list)
    all: list[str] = field(default_factory=list)
    sound: bool = True

    @property
    def optional(self) -> bool:
        return self.order.reward is not None

    def add(self, action: Raw) -> None:
        self.own.append(action)
        self.all.append(action["id"])

    def group(self) -> Raw | None:
        """What may be left alone, or has a deadline, is a group; anything else needs none.

        A deadline of an obligation holds for all that it needs, whoever asked for it first.
        """
        order = self.order
        members = [action["id"] for action in self.own] if self.optional else self.all
        if not members or (not self.optional and order.deadline is None):
            return None
        return {
            "id": order.id,
            "actions": members,
            **({"required": False, "reward": order.reward} if self.optional else {}),
            **({} if order.deadline is None else {"deadline": order.deadline}),
        }


class Book:
    """All orders so far, and what they need of the kitchen. Faults are recorded where they are."""

    def __init__(self, kitchen: Kitchen, stock: Mapping[str, int]) -> None:
        self.kitchen, self.stock = kitchen, stock
        self.items: dict[str, _Progress] = {}
        self.consumed: set[str] = set()
        self._orders: set[str] = set()
        self._actions: set[str] = set()
        self._lags: set[Any] = set()
        self._goals: dict[str, Raw | str] = {}

    @property
    def stations(self) -> set[str]:
        """The stations that some order needs."""
        return {step.station for progress in self.items.values() for step in progress.steps}

    @property
    def idle(self) -> list[str]:
        """The items that no order names."""
        return [name for name, p in self.items.items() if not p.steps and not p.stacked]

    def reveal(self, revelation: Revelation) -> Additions:
        """Takes what becomes known at one moment.

        Obligations come first, so that no order with a reward holds the work that they need. What
        is stacked waits for all that is wanted of it by then.
        """
        new = Additions()
        before = dict(self._goals)
        self.items.update((name, _Progress(item)) for name, item in revelation.items.items())
        _check_one_state(revelation.orders)
        orders = sorted(revelation.orders, key=lambda order: order.reward is not None)
        drafts = [_Draft(order) for order in orders if self._is_new(order)]
        for draft in drafts:
            for wish in draft.order.wishes:
                draft.sound &= self._process(wish, draft, new)
        for draft in drafts:
            self._stack(draft, new)
            self._finish(draft, new)
        self._time(revelation.lags, new)
        if self._goals != before:
            new.goals = list(self._goals.values())
        return new

    def _is_new(self, order: Order) -> bool:
        if order.id in self._orders:
            order.part.fault(f"the order {order.id!r} is already there")
            return False
        self._orders.add(order.id)
        return True

    # --- processing ---

    def _process(self, wish: Wish, draft: _Draft, new: Additions) -> bool:
        """Takes an item on to the state that an order wants of it; tells where it cannot."""
        progress = self.items[wish.item]
        try:
            steps = progress.steps_on_to(wish.state)
        except UnreachableError as error:
            wish.part.fault(str(error))
            return False
        able = [self._able(step, wish.part) for step in steps]
        if not all(able) or (draft.optional and not self._may_choose(wish, steps, draft)):
            return False
        if not draft.optional:
            self._oblige(progress)
        elif steps:  # It need no longer end where an obligation wants it to come to.
            self._goals.pop(wish.item, None)
        draft.all += progress.actions
        for step in steps:
            self._declare(progress, new)
            progress.steps.append(step)
            draft.add(processing(step, self.kitchen))
        if draft.optional:
            progress.chosen.update(action_id(step.action, step.item) for step in steps)
        elif progress.steps:
            self._goals[wish.item] = {"var": wish.item, "value": progress.state}
        return True

    def _able(self, step: Step, part: Part) -> bool:
        """Whether the kitchen can take a step; tells where it cannot."""
        there = step.station in self.kitchen.stations
        if not there:
            part.fault(f"there is no station {step.station!r} to {step.action} {step.item!r}")
        return self._timed(step.action, step.item, part) and there

    def _timed(self, action: str, item: str, part: Part) -> bool:
        if action in self.kitchen.durations:
            return True
        part.fault(f"'action_durations' has no {action!r}, which {item!r} needs")
        return False

    def _oblige(self, progress: _Progress) -> None:
        """An obligation needs what so far only a chosen order would do: it must be there."""
        for name in progress.actions:
            if name in progress.chosen:
                progress.chosen.discard(name)
                self._goals[name] = name

    def _may_choose(self, wish: Wish, steps: Sequence[Step], draft: _Draft) -> bool:
        """Whether an order that may be left alone has an action to say so by; tells where not."""
        progress = self.items[wish.item]
        if steps or not progress.steps or wish.item in draft.order.stacked:
            return True
        if not progress.chosen and draft.order.deadline is None:
            return True
        wish.part.fault(
            f"another goal makes {wish.item!r} {wish.state!r} already, so this order, "
            "which may be left alone, has no say in whether or when"
        )
        return False

    def _declare(self, progress: _Progress, new: Additions) -> None:
        """The state variable of an item that can be in several states, with its first action."""
        states = states_of(progress.item)
        if not progress.declared and len(states) > 1:
            name = progress.item.name
            new.state.append({"id": name, "values": list(states), "initial": progress.item.state})
            progress.declared = True

    # --- stacking, groups, lags ---

    def _stack(self, draft: _Draft, new: Additions) -> None:
        for name, part in _stacked(draft.order):
            progress = self.items[name]
            if progress.stacked:
                part.fault(f"item {name!r} is already stacked by another order")
            elif progress.chosen and not draft.optional:
                part.fault(f"whether {name!r} is {progress.state!r} is left to another order")
            elif self._timed(STACK, name, part):
                self._declare(progress, new)
                progress.stacked = True
                state = progress.state if progress.declared else None
                draft.add(stacking(name, state, self.kitchen))
        new.precedence += stack_order(draft.order.stacked)

    def _finish(self, draft: _Draft, new: Additions) -> None:
        """The order's actions, what it costs, and its group where it needs one."""
        order = draft.order
        for name in order.cost.keys() - self.stock.keys():
            order.part.fault(f"'inventory_limits' has no {name!r}, which it costs")
        if draft.own:
            take(order.cost, draft.own[0])
            self.consumed |= {name for name, amount in order.cost.items() if amount}
        elif draft.optional and draft.sound:
            order.part.fault("it holds already, so there is nothing to choose")
        new.actions += draft.own
        self._actions.update(action["id"] for action in draft.own)
        new.rewarded |= draft.optional
        if group := draft.group():
            new.groups.append(group)

    def _time(self, found: Sequence[Lag], new: Additions) -> None:
        check_lags(found, self._actions)
        for lag in found:
            said = (lag.before, lag.after, lag.min_lag, lag.max_lag)
            if said not in self._lags:
                self._lags.add(said)
                new.precedence += lags([lag])


def _stacked(order: Order) -> Iterator[tuple[str, Part]]:
    """The items of its dish, each with its place in the file."""
    if not order.stacked:
        return
    whole = order.part.child("stack_order", order.part.value["stack_order"])
    # (A dish that names an item twice is a fault, and does not come this far.)
    for k, name in enumerate(order.stacked):
        yield name, whole.child(k, name)


def _check_one_state(orders: Sequence[Order]) -> None:
    """At one moment no item is wanted in two states."""
    wanted: dict[str, Wish] = {}
    for wish in (wish for order in orders for wish in order.wishes):
        other = wanted.setdefault(wish.item, wish)
        if other.state != wish.state:
            wish.part.fault(
                f"item {wish.item!r} is wanted {other.state!r} at the same moment, "
                "and has one state at the end"
            )
