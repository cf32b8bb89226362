#!/usr/bin/env python3
"""Export the accepted episodes as LeRobot data sets (ninth stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("export")
