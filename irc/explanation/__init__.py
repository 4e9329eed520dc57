"""Explanations: in, a `Task`; out, why it has no schedule, or why its schedule is not shorter.

`explain` runs the stages. (The package is not called `explain`, the name of `irc.explain`.)
"""

from __future__ import annotations

from irc.explanation.explain import explain_task
from irc.explanation.lateness import Lateness, explain_lateness
from irc.explanation.result import Explanation

__all__ = ["Explanation", "Lateness", "explain_lateness", "explain_task"]
