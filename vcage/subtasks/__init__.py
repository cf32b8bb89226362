"""Sub-tasks: the pick-and-place template, feasibility, search, scripts and the task chain."""
