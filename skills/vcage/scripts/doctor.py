#!/usr/bin/env python3
"""Say what is missing, and which command fixes it."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("doctor")
