"""What variables of a model are called, for people who read it."""

from __future__ import annotations

from irc.problem import PLAIN, Activity


def name_of(activity: Activity) -> str:
    """Its id, and its number where it is a later occurrence."""
    if activity.details is PLAIN or activity.details.occurrence == 1:
        return activity.id
    return f"{activity.id} ({activity.details.occurrence})"
