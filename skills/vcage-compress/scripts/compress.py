#!/usr/bin/env python3
"""Compress the episodes' pictures without visible loss (eighth stage)."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("compress")
