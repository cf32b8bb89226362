"""Measure: ``python -m benchmarks NAME [--quick] [options]`` prints one JSON object as its last line.

The log ends with the same figures as a table.

Each module of this package with a ``run(quick: bool, **options) -> dict`` is a benchmark; one that takes options
declares them in ``add_arguments(parser)``. ``python -m benchmarks NAME --help`` lists them.
"""

from __future__ import annotations

import argparse
import importlib
import json
import logging
import pkgutil
import sys
from collections.abc import Sequence

import benchmarks
from benchmarks import _table
from vcage.base.errors import VcageError

logger = logging.getLogger(__name__)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the benchmark that the command line names; the exit code is 0, or that of the error."""
    argv = sys.argv[1:] if argv is None else list(argv)
    names = sorted(m.name for m in pkgutil.iter_modules(benchmarks.__path__) if not m.name.startswith("_"))
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("name", choices=names)
    # Only the benchmark that is named gets loaded, so its options are read by a parser of its own.
    name = parser.parse_args(argv[:1]).name
    module = importlib.import_module(f"benchmarks.{name}")
    parser = argparse.ArgumentParser(prog=f"python -m benchmarks {name}", description=module.__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer repetitions: seconds, not minutes")
    if hasattr(module, "add_arguments"):
        module.add_arguments(parser)
    options = vars(parser.parse_args(argv[1:]))
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    try:
        figures = module.run(**options)
    except VcageError as error:
        print(error.as_line(), file=sys.stderr)
        print(json.dumps({"error": error.as_record()}))
        return error.exit_code
    for line in _table.lines(figures):
        logger.info("%s", line)
    print(json.dumps(figures))
    return 0


if __name__ == "__main__":
    sys.exit(main())
