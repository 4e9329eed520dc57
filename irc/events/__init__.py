"""Events: in, a task and an event; out, the task as the event revises it."""

from irc.events.apply import apply

__all__ = ["apply"]
