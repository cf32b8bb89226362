#!/usr/bin/env python3
"""Record verified episodes (sixth stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("collect")
