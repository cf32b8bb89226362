#!/usr/bin/env python3
"""Prove objects by use in the simulator."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("assets validate")
