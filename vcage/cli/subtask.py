"""The entry of a generated sub-task script that is run by itself: its own scene, its own run folder."""

from __future__ import annotations

import argparse
import inspect
import sys
from pathlib import Path

from vcage.cli.arguments import Parser, folder
from vcage.cli.output import Result, end_process, run_cli, stray_output_on_stderr
from vcage.cli.progress import set_up_logging
from vcage.cli.stages import collect
from vcage.cli.stages.common import execute_stage


def run_script(path: str, argv: list[str] | None = None) -> int:
    """Collect episodes of one sub-task script into a run folder of its own; returns the exit code."""
    code = run_cli(lambda: _run(Path(path).resolve(), sys.argv[1:] if argv is None else argv))
    return end_process(code) if argv is None else code


def _run(path: Path, argv: list[str]) -> Result | None:
    from vcage.tasks.synthesis import load_script

    script = load_script(path)
    parser = Parser(path.name, f"{script.values['TEXT']}\n\n{inspect.cleandoc(collect.__doc__ or '').splitlines()[0]}")
    parser.add_argument("--out", required=True, type=folder, metavar="DIR", help="the run folder")
    collect.add_arguments(parser, run=False)
    parser.add_argument("-v", "--verbose", action="store_true", help="say more on stderr")
    try:
        args = parser.parse_args(argv)
    except SystemExit:  # after --help
        return None
    set_up_logging(args.verbose)
    with stray_output_on_stderr():
        return _collect(path, args)


def _collect(path: Path, args: argparse.Namespace) -> Result:
    from vcage.base.files import RunFolder
    from vcage.stages.script_run import prepare_run

    prepare_run(RunFolder(args.out), path, seed=args.seed or 0, force=args.force)
    return execute_stage("collect", args, args.out)
