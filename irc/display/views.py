"""The views of a schedule that a later stage makes: tables, charts and files.

They are loaded by their names when they are first asked for, as backends are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

VIEWS: Mapping[str, str] = {
    "orders": "irc.reporting.frames:orders",
    "resources": "irc.reporting.frames:resources",
    "days": "irc.reporting.frames:days",
    "plot": "irc.reporting.charts:plot",
    "save": "irc.reporting.files:save",
}
"""The functions that make them, from (task, schedule, …)."""


def view(name: str) -> Callable[..., Any]:
    """The function that makes a view."""
    module, _, function = VIEWS[name].partition(":")
    made: Callable[..., Any] = getattr(import_module(module), function)
    return made
