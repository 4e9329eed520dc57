"""Runs another fake through irc.targets.process, as a planner's wrapper that uses irc would."""

import sys

from irc.targets.process import ProcessLimits, run

run(
    [sys.executable, *sys.argv[1:]],
    ProcessLimits(),
    on_line=lambda line: print(line, flush=True),
)
