"""Why a task has no schedule, or why its schedule is as long as it is.

`statements` says what a statement of the IR is, `road` is the way from a task to an explanation.
(The package is not called `explain`: that is the name of the function, `irc.explain`.)
"""

from __future__ import annotations

from irc.explanation.explain import explain_task
from irc.explanation.result import Explanation

__all__ = ["Explanation", "explain_task"]
