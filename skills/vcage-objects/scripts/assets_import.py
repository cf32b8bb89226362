#!/usr/bin/env python3
"""Bring in objects of RoboTwin or YCB."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("assets import")
