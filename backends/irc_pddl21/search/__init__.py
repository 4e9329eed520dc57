"""From a program and a planner to an outcome: the problems that a planner is asked, and in turn."""
