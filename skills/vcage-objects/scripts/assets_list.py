#!/usr/bin/env python3
"""Say what the library of objects holds."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("assets list")
