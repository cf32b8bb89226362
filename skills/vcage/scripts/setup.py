#!/usr/bin/env python3
"""Fetch or build what a run needs."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("setup")
