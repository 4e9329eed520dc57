"""Online: events revise a task while it runs (design: "Online").

`apply` revises a task by one event, `check_event` says what is wrong with an event for a task.
"""

from irc.online.checking import check_event
from irc.online.revision import apply

__all__ = ["apply", "check_event"]
