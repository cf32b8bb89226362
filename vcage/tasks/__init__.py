"""Episodes: the task API that sub-task scripts call, and the closed loop around them."""
