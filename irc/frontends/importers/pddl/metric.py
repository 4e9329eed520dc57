"""The metric of a PDDL problem as objectives of the IR."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

from irc.frontends.importers.pddl.formula import Decider, NotSupportedError
from irc.frontends.importers.pddl.ground_action import Ground, NumericEffect
from irc.frontends.importers.pddl.lifted import Fact, Lifted
from irc.frontends.importers.pddl.values import TIME


@dataclass(frozen=True)
class Objective:
    """`names` as in the IR; `weights` of the functions that an action's cost is made of.

    A cost is a whole number: the metric times `scale`. `mixed`: time and cost were weighed against
    each other, which the IR cannot say.
    """

    names: tuple[str, ...] = ("minimize_makespan",)
    weights: Mapping[Fact, Fraction] | None = None
    scale: int = 1
    mixed: bool = False

    def cost(self, action: Ground) -> int:
        """The amount by which an occurrence of an action changes the metric, times `scale`."""
        return int(_cost(action, self.weights or {}) * self.scale)


def objective_of(lifted: Lifted, actions: Sequence[Ground]) -> Objective:
    """The objectives of a problem. Raises `NotSupportedError` with a place in the problem."""
    metric = lifted.metric
    if metric is None:
        return Objective()
    linear = Decider(lifted, set()).linear(metric.expression, {})
    if linear is None:
        return Objective()
    weights = dict(linear.times(Fraction(-1 if metric.maximize else 1)).factors)
    time = weights.pop(TIME, Fraction(0))
    if time < 0:
        raise NotSupportedError(
            "this metric prefers longer plans; only minimized time is supported", metric.offset
        )
    if not weights:
        return Objective()
    for action in actions:
        for effect in _changes(action):
            if effect.fact in weights and not effect.add:
                name = " ".join(effect.fact)
                raise NotSupportedError(
                    f"this metric depends on ({name}), which {action.text} assigns; only what is"
                    " increased or decreased by constants can be minimized",
                    metric.offset,
                )
    scale = lcm(*(_cost(action, weights).denominator for action in actions))
    names = ("minimize_makespan", "minimize_cost") if time else ("minimize_cost",)
    return Objective(names, weights, scale, mixed=bool(time))


def _cost(action: Ground, weights: Mapping[Fact, Fraction]) -> Fraction:
    found = Fraction(0)
    for effect in _changes(action):
        if effect.add:
            found += weights.get(effect.fact, Fraction(0)) * effect.amount
    return found


def _changes(action: Ground) -> Iterable[NumericEffect]:
    return [made.effect for made in action.effects if isinstance(made.effect, NumericEffect)]
