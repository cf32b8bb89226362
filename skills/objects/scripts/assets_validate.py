#!/usr/bin/env python3
"""Prove objects by use in the simulator."""

import pathlib
import runpy
import sys

runpy.run_path(str(pathlib.Path(__file__).resolve().parents[2] / "environment.py"))

from vcage.cli.main import script_main

if __name__ == "__main__":  # processes that it starts read it again
    sys.exit(script_main("assets validate"))
