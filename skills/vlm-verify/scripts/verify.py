#!/usr/bin/env python3
"""Judge episodes, or two pictures, against a sub-task's text (seventh stage)."""

import pathlib
import runpy
import sys

runpy.run_path(str(pathlib.Path(__file__).resolve().parents[2] / "environment.py"))

from vcage.cli.main import script_main

if __name__ == "__main__":  # processes that it starts read it again
    sys.exit(script_main("verify"))
