#!/usr/bin/env python3
"""Judge episodes, or two pictures, against a sub-task's text (seventh stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("verify")
