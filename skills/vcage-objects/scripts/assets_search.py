#!/usr/bin/env python3
"""Find objects by meaning."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("assets search")
