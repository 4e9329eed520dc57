"""Modes of an activity: their durations, and the claims that they have."""

from __future__ import annotations

from irc.problem import Activity, Claim


def modes_of(activity: Activity) -> range | tuple[None]:
    """The indexes of an activity's modes; None alone where it has none."""
    return range(len(activity.details.modes)) if activity.details.modes else (None,)


def span_of(activity: Activity, mode: int | None) -> tuple[int, int]:
    """Least and greatest duration in a mode, in ticks."""
    if mode is None:
        return activity.duration_min, activity.duration_max
    chosen = activity.details.modes[mode]
    return chosen.duration_min, chosen.duration_max


def claims_in(activity: Activity, mode: int | None) -> tuple[Claim, ...]:
    """The claims of an activity in a mode; a mode without duration has none."""
    if mode is None:
        return activity.claims
    if not span_of(activity, mode)[1]:
        return ()
    use_mode = activity.details.use_mode
    return tuple(c for c in activity.claims if use_mode(c.use) in (None, mode))
