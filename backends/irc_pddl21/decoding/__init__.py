"""From the text that a planner printed to the exact schedule of its best plan."""
