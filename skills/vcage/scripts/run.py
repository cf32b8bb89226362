#!/usr/bin/env python3
"""Turn an instruction into a data set: all stages, then the report."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("run")
