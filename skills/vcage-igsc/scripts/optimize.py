#!/usr/bin/env python3
"""Turn the matches into a layout without collisions (fourth stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("optimize")
