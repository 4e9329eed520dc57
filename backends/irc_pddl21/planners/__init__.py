"""From two PDDL files to plans: the planners, and one run of a planner in a child process."""
