"""Measure: ``python -m benchmarks NAME [--quick]`` prints one JSON object as its last line.

Each module of this package with a ``run(quick: bool) -> dict`` is a benchmark.
"""

from __future__ import annotations

import argparse
import importlib
import json
import logging
import pkgutil
import sys

import benchmarks


def main() -> int:
    """Run the benchmark that the command line names."""
    names = sorted(m.name for m in pkgutil.iter_modules(benchmarks.__path__) if not m.name.startswith("_"))
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("name", choices=names)
    parser.add_argument("--quick", action="store_true", help="fewer repetitions: seconds, not minutes")
    args = parser.parse_args()
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    figures = importlib.import_module(f"benchmarks.{args.name}").run(args.quick)
    print(json.dumps(figures))
    return 0


if __name__ == "__main__":
    sys.exit(main())
