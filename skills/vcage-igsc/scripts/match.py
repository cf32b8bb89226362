#!/usr/bin/env python3
"""Find every object of the scene in the target picture (third stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("match")
