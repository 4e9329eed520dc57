"""Occurrences of repeated actions in a CP-SAT model."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irc_cpsat.encoding.builder import Builder

FILE_DEPTH = 4
"""The number of occurrences of an action that may repeat in a model that is written out."""


def add_occurrences(builder: Builder) -> None:
    """Orders the occurrences of one action, without gaps in their numbers."""
    for i, activity in enumerate(builder.problem.activities):
        previous = activity.details.previous_occurrence
        if previous is None:
            continue
        builder.enforced(builder.model.add(builder.starts[i] >= builder.end(previous)), i)
        here, there = builder.present[i], builder.present[previous]
        if here is not None and there is not None:
            builder.model.add_implication(here, there)
