#!/usr/bin/env python3
"""Find the feasible sub-tasks and write a script for each (fifth stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("search-subtasks")
