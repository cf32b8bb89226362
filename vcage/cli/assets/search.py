"""Find objects of the library by what they are called, what they are for, or what they mean.

With the extra `search` installed (pip install 'vcage[search]') sentences are compared by their meaning, else by their
words.

examples:
  vcage assets search something to drink from
  vcage assets search torch --top 3
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import positive


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage assets search``."""
    parser.add_argument("words", nargs="+", metavar="WORDS", help="what to look for")
    parser.add_argument("--top", type=positive, default=10, metavar="N", help="how many to show (default: %(default)s)")


def execute(args: argparse.Namespace) -> Result:
    """Search."""
    from vcage.models.search import best_search
    from vcage.objects.library import Library

    engine = best_search()
    query = " ".join(args.words)
    found = [pair for pair in engine.search(query, Library.load().entries(), args.top) if pair[1] > 0]
    lines = [f"{score:5.2f}  {entry.name}: {entry.words.description}" for entry, score in found]
    return Result(
        text="\n".join(lines) or "nothing found",
        facts={
            "query": query,
            "provider": engine.provider,
            "found": [{"name": entry.name, "score": round(score, 4)} for entry, score in found],
        },
    )
