"""The ``vcage`` command: a table of sub-commands, each imported only when it is the one that runs."""

from __future__ import annotations

import importlib
import inspect
import sys
from pathlib import Path

from vcage import __version__
from vcage.base.errors import UnknownName, UsageError
from vcage.cli.arguments import Parser
from vcage.cli.output import Result, end_process, run_cli, stray_output_on_stderr
from vcage.cli.progress import set_up_logging

COMMANDS: dict[str, tuple[str, str]] = {
    "run": ("vcage.cli.run", "the whole chain: from an instruction to a data set and its report"),
    "select-place": ("vcage.cli.stages.select_place", "1. choose the objects and place them"),
    "inpaint-plan": ("vcage.cli.stages.inpaint_plan", "2. plan the layout and draw it"),
    "match": ("vcage.cli.stages.match", "3. find the objects in the drawn layout"),
    "optimize": ("vcage.cli.stages.optimize", "4. make the layout collision-free"),
    "search-subtasks": ("vcage.cli.stages.search_subtasks", "5. find feasible sub-tasks and chain them"),
    "collect": ("vcage.cli.stages.collect", "6. let the robot do it, verified step by step"),
    "verify": ("vcage.cli.stages.verify", "7. judge episodes or pictures again"),
    "compress": ("vcage.cli.stages.compress", "8. compress videos of a run, or any recordings"),
    "export": ("vcage.cli.stages.export", "9. write LeRobot data sets"),
    "decompress": ("vcage.cli.decompress", "put the pictures of compressed recordings back"),
    "report": ("vcage.cli.report", "write the HTML page of a run"),
    "view": ("vcage.cli.view", "look at an episode in the viewer Rerun"),
    "assets list": ("vcage.cli.assets.listing", "list the objects of the library"),
    "assets search": ("vcage.cli.assets.search", "find objects by what they are called or mean"),
    "assets validate": ("vcage.cli.assets.validate", "prove the objects by use: stand, grasp, fill, open"),
    "assets gallery": ("vcage.cli.assets.gallery", "draw every object on one page"),
    "assets import": ("vcage.cli.assets.importing", "bring in objects of RoboTwin or YCB"),
    "robots list": ("vcage.cli.robots.listing", "list the robots"),
    "robots import": ("vcage.cli.robots.importing", "bring in a robot of RoboTwin"),
    "doctor": ("vcage.cli.doctor", "say what this machine has, and how to mend what it lacks"),
    "setup": ("vcage.cli.setup", "fetch or build what a run needs: vulkan, assets, cvvdp, opencv, all"),
}
"""Name of one or two words → (module, one line of help). A module offers ``add_arguments(parser)`` and
``execute(args) -> Result``, and its docstring is the command's help."""


def main(argv: list[str] | None = None) -> int:
    """Entry of the ``vcage`` command; returns the exit code."""
    arguments = sys.argv[1:] if argv is None else argv
    code = run_cli(lambda: _dispatch(arguments))
    return end_process(code) if argv is None else code


def script_main(command: str, argv: list[str] | None = None) -> int:
    """Entry of a script that is one sub-command; its help shows the script's own name."""
    arguments = sys.argv[1:] if argv is None else argv
    code = run_cli(lambda: _run(command, arguments, prog=Path(sys.argv[0]).name))
    return end_process(code) if argv is None else code


def _dispatch(arguments: list[str]) -> Result | None:
    if not arguments:
        raise UsageError("no command given", hint="see: vcage --help")
    if arguments[0] in ("-h", "--help"):
        sys.stdout.write(help_text())
        return None
    if arguments[0] == "--version":
        sys.stdout.write(f"vcage {__version__}\n")
        return None
    if any(name.startswith(f"{arguments[0]} ") for name in COMMANDS):
        if arguments[1:] in (["-h"], ["--help"]):
            sys.stdout.write(help_text(arguments[0]))
            return None
        arguments = [" ".join(arguments[:2]), *arguments[2:]]
    command, *rest = arguments
    if command not in COMMANDS:
        raise UnknownName("command", command, COMMANDS)
    return _run(command, rest, prog=f"vcage {command}")


def _run(command: str, arguments: list[str], prog: str) -> Result | None:
    module = importlib.import_module(COMMANDS[command][0])
    try:
        options = parser_of(command, prog).parse_args(arguments)
    except SystemExit:  # after --help
        return None
    set_up_logging(options.verbose)
    with stray_output_on_stderr():
        return module.execute(options)


def parser_of(command: str, prog: str) -> Parser:
    """The parser of a sub-command, whose help shows ``prog`` as its name."""
    module = importlib.import_module(COMMANDS[command][0])
    parser = Parser(prog, inspect.getdoc(module) or "")
    module.add_arguments(parser)
    parser.add_argument("-v", "--verbose", action="store_true", help="say more on stderr")
    return parser


def help_text(group: str = "") -> str:
    """The text of ``vcage --help``, or of a group of commands (``vcage assets --help``)."""
    shown = {name: text for name, (_, text) in COMMANDS.items() if name.startswith(group)}
    width = max(map(len, shown))
    lines = [f"  {name:<{width}}  {text}" for name, text in shown.items()]
    return "\n".join(
        [
            f"usage: vcage {group or 'COMMAND'}{' ACTION' if group else ''} [options]",
            "",
            "An instruction in plain language goes in; a verified robot-manipulation dataset comes out.",
            "",
            *lines,
            "",
            "The last line of stdout is one JSON object. `vcage COMMAND --help` says more; `vcage --version`.",
            "",
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
