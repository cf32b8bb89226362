#!/usr/bin/env python3
"""Plan the layout and draw the target picture (second stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("inpaint-plan")
