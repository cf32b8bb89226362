#!/usr/bin/env python3
"""Choose objects for an instruction and place them on the table (first stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("select-place")
