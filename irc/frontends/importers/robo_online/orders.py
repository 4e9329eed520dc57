"""Adds the orders of an episode to the task, as they are revealed.

The actions of an obligation (an order without a reward) occur once. An order with a reward is an
optional group. The processing of an item is kept in stages, so that a later order can continue
where the earlier ones end.
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
    ProcessingStep,
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
from irc.frontends.importers.robo_online.document import KitchenOrder, Revelation, WantedState

Raw = dict[str, Any]


@dataclass
class Additions:
    """The additions of a revelation, as parts of an IR document.

    `goals` are all goals from then on; None if they do not change. `rewarded` is whether some new
    order has a reward.
    """

    state: list[Raw] = field(default_factory=list)
    actions: list[Raw] = field(default_factory=list)
    precedence: list[Raw] = field(default_factory=list)
    groups: list[Raw] = field(default_factory=list)
    goals: list[Raw | str] | None = None
    rewarded: bool = False


@dataclass
class _Progress:
    """The processing of an item by all orders: its steps, and those of optional orders only."""

    item: Item
    steps: list[ProcessingStep] = field(default_factory=list)
    chosen: set[str] = field(default_factory=set)
    stacked: bool = False
    declared: bool = False

    @property
    def state(self) -> str:
        """The state of the item after the orders so far."""
        return self.steps[-1].after if self.steps else self.item.state

    @property
    def actions(self) -> list[str]:
        """The ids of its processing, in order."""
        return [action_id(step.action, step.item) for step in self.steps]

    def steps_on_to(self, state: str) -> tuple[ProcessingStep, ...]:
        """The remaining steps to a state. Raises `UnreachableError`."""
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
class _OpenOrder:
    """An order that is being added: its new actions, and all actions that it needs.

    `sound` is whether all of its parts could be added.
    """

    order: KitchenOrder
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
        """The group of an order that is optional or has a deadline; None for other orders.

        The deadline of an obligation holds for all actions that it needs, also for those that an
        earlier order added.
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
    """All orders so far, and the parts of the kitchen that they need. Faults are recorded."""

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
        """The additions of what becomes known at one moment.

        Obligations come first, so that no order with a reward owns work that they need. The
        stacking of an item waits for all processing that is wanted by then.
        """
        new = Additions()
        before = dict(self._goals)
        self.items.update((name, _Progress(item)) for name, item in revelation.items.items())
        _check_one_state(revelation.orders)
        orders = sorted(revelation.orders, key=lambda order: order.reward is not None)
        open_orders = [_OpenOrder(order) for order in orders if self._is_new(order)]
        for open_order in open_orders:
            for wanted in open_order.order.wanted:
                open_order.sound &= self._process(wanted, open_order, new)
        for open_order in open_orders:
            self._stack(open_order, new)
            self._finish(open_order, new)
        self._time(revelation.lags, new)
        if self._goals != before:
            new.goals = list(self._goals.values())
        return new

    def _is_new(self, order: KitchenOrder) -> bool:
        if order.id in self._orders:
            order.part.fault(f"the order {order.id!r} already exists")
            return False
        self._orders.add(order.id)
        return True

    # --- processing ---

    def _process(self, wanted: WantedState, open_order: _OpenOrder, new: Additions) -> bool:
        """Adds the steps of an item to the state that an order wants; reports it if impossible."""
        progress = self.items[wanted.item]
        try:
            steps = progress.steps_on_to(wanted.state)
        except UnreachableError as error:
            wanted.part.fault(str(error))
            return False
        able = [self._able(step, wanted.part) for step in steps]
        if not all(able) or (
            open_order.optional and not self._may_choose(wanted, steps, open_order)
        ):
            return False
        if not open_order.optional:
            self._oblige(progress)
        elif steps:  # The item need no longer end in the state that an obligation wants.
            self._goals.pop(wanted.item, None)
        open_order.all += progress.actions
        for step in steps:
            self._declare(progress, new)
            progress.steps.append(step)
            open_order.add(processing(step, self.kitchen))
        if open_order.optional:
            progress.chosen.update(action_id(step.action, step.item) for step in steps)
        elif progress.steps:
            self._goals[wanted.item] = {"var": wanted.item, "value": progress.state}
        return True

    def _able(self, step: ProcessingStep, part: Part) -> bool:
        """Whether the kitchen has the station and the duration of a step; reports missing ones."""
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
        """Makes steps that only optional orders need required, because an obligation needs them."""
        for name in progress.actions:
            if name in progress.chosen:
                progress.chosen.discard(name)
                self._goals[name] = name

    def _may_choose(
        self, wanted: WantedState, steps: Sequence[ProcessingStep], open_order: _OpenOrder
    ) -> bool:
        """Whether an optional order has an action of its own; reports it if not."""
        progress = self.items[wanted.item]
        if steps or not progress.steps or wanted.item in open_order.order.stacked:
            return True
        if not progress.chosen and open_order.order.deadline is None:
            return True
        wanted.part.fault(
            f"another goal makes {wanted.item!r} {wanted.state!r} already, so this optional "
            "order decides nothing"
        )
        return False

    def _declare(self, progress: _Progress, new: Additions) -> None:
        """Adds the state variable of an item with several states, with its first action."""
        states = states_of(progress.item)
        if not progress.declared and len(states) > 1:
            name = progress.item.name
            new.state.append({"id": name, "values": list(states), "initial": progress.item.state})
            progress.declared = True

    # --- stacking, groups, lags ---

    def _stack(self, open_order: _OpenOrder, new: Additions) -> None:
        for name, part in _stacked(open_order.order):
            progress = self.items[name]
            if progress.stacked:
                part.fault(f"item {name!r} is already stacked by another order")
            elif progress.chosen and not open_order.optional:
                part.fault(f"whether {name!r} is {progress.state!r} is left to another order")
            elif self._timed(STACK, name, part):
                self._declare(progress, new)
                progress.stacked = True
                state = progress.state if progress.declared else None
                open_order.add(stacking(name, state, self.kitchen))
        new.precedence += stack_order(open_order.order.stacked)

    def _finish(self, open_order: _OpenOrder, new: Additions) -> None:
        """Adds the order's actions, its cost, and its group if it needs one."""
        order = open_order.order
        for name in order.cost.keys() - self.stock.keys():
            order.part.fault(f"'inventory_limits' has no {name!r}, which this order costs")
        if open_order.own:
            take(order.cost, open_order.own[0])
            self.consumed |= {name for name, amount in order.cost.items() if amount}
        elif open_order.optional and open_order.sound:
            order.part.fault("it is fulfilled already, so there is nothing to choose")
        new.actions += open_order.own
        self._actions.update(action["id"] for action in open_order.own)
        new.rewarded |= open_order.optional
        if group := open_order.group():
            new.groups.append(group)

    def _time(self, found: Sequence[Lag], new: Additions) -> None:
        check_lags(found, self._actions)
        for lag in found:
            said = (lag.before, lag.after, lag.min_lag, lag.max_lag)
            if said not in self._lags:
                self._lags.add(said)
                new.precedence += lags([lag])


def _stacked(order: KitchenOrder) -> Iterator[tuple[str, Part]]:
    """The items of its dish, each with its place in the file."""
    if not order.stacked:
        return
    whole = order.part.child("stack_order", order.part.value["stack_order"])
    # (A dish that names an item twice is reported before.)
    for k, name in enumerate(order.stacked):
        yield name, whole.child(k, name)


def _check_one_state(orders: Sequence[KitchenOrder]) -> None:
    """Reports items that are wanted in two states at one moment."""
    first: dict[str, WantedState] = {}
    for wanted in (wanted for order in orders for wanted in order.wanted):
        other = first.setdefault(wanted.item, wanted)
        if other.state != wanted.state:
            wanted.part.fault(
                f"item {wanted.item!r} is wanted {other.state!r} at the same moment, "
                "and has one state at the end"
            )
