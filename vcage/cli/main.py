"""The ``vcage`` command: a table of sub-commands, each imported only when it runs."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vcage.base.commands import CALLED, vcage_command
from vcage.base.errors import UnknownName, UsageError
from vcage.base.version import __version__
from vcage.cli.output import Result, run_cli
from vcage.cli.process import end_process, prepare, require_fit
from vcage.cli.progress import set_up
from vcage.cli.streams import print_text, stray_output_on_stderr

if TYPE_CHECKING:
    from vcage.cli.arguments import Command, CommonOptions

COMMANDS: dict[str, tuple[str, str]] = {
    "run": ("vcage.cli.run.Run", "the whole chain: from an instruction to a data set and its report"),
    "campaign": ("vcage.cli.campaign.Campaign", "many runs by one plan, on one machine or many"),
    "status": ("vcage.cli.campaign.CampaignStatus", "how a campaign stands"),
    "select-place": ("vcage.stages.select_place", "1. choose the objects and place them"),
    "inpaint-plan": ("vcage.stages.inpaint_plan", "2. plan the layout and draw it"),
    "match": ("vcage.stages.match", "3. find the objects in the drawn layout"),
    "optimize": ("vcage.stages.optimize", "4. make the layout collision-free"),
    "search-subtasks": ("vcage.stages.search_subtasks", "5. find feasible sub-tasks and chain them"),
    "collect": ("vcage.stages.collect", "6. let the robot do it, verified step by step"),
    "verify": ("vcage.cli.verify.Verify", "7. judge episodes or pictures again"),
    "render": ("vcage.cli.recorded.RenderEpisodes", "draw episodes again under other looks, without simulating"),
    "compress": ("vcage.cli.compress.Compress", "8. compress videos of a run, or any recordings"),
    "export": ("vcage.cli.export.ExportEpisodes", "9. write LeRobot data sets"),
    "merge": ("vcage.cli.merge.MergeRuns", "write one LeRobot data set of many runs"),
    "decompress": ("vcage.cli.compress.Decompress", "put the pictures of compressed recordings back"),
    "replay": ("vcage.cli.recorded.Replay", "simulate recorded episodes again, and say what differs"),
    "report": ("vcage.cli.recorded.Report", "write the HTML page of a run"),
    "evaluate": ("vcage.cli.evaluate.Evaluate", "let a policy act in the scenes of a run, and count successes"),
    "serve": ("vcage.cli.serve.Serve", "serve the environments of a run over a socket"),
    "view": ("vcage.cli.recorded.ViewEpisode", "look at an episode in the viewer Rerun"),
    "prompts show": ("vcage.cli.prompts.ShowPrompt", "print what a model would be asked in a run"),
    "assets list": ("vcage.cli.assets.ListAssets", "list the objects of the library"),
    "assets search": ("vcage.cli.assets.SearchAssets", "find objects by what they are called or mean"),
    "assets validate": ("vcage.cli.assets.ValidateAssets", "prove the objects by use: stand, grasp, fill, open"),
    "assets gallery": ("vcage.cli.assets.DrawGallery", "draw every object on one page"),
    "assets import": ("vcage.cli.assets.ImportAssets", "bring in objects of RoboTwin or YCB"),
    "robots list": ("vcage.cli.robots.ListRobots", "list the robots"),
    "robots import": ("vcage.cli.robots.ImportRobot", "bring in a robot of RoboTwin"),
    "doctor": ("vcage.cli.doctor.Doctor", "say what this machine has, and how to fix what it lacks"),
    "setup": ("vcage.cli.setup.Setup", "fetch or build what a run needs: vulkan, assets, cvvdp, opencv, all"),
}
"""Name of one or two words → (the class of the command, or the module of the stage; one line of help)."""


@dataclass(frozen=True)
class Entry:
    """An imported command.

    Args:
        options: a dataclass that tyro parses.
        text: the help without the options.
        execute: runs the command with its options.
    """

    options: type[CommonOptions]
    text: str
    execute: Callable[[Any], Result]


def load(name: str) -> Entry:
    """Import a command."""
    place = COMMANDS[name][0]
    if place.startswith("vcage.stages."):
        from vcage.cli.stage import execute_stage, options_of

        module, stage = importlib.import_module(place), place.removeprefix("vcage.stages.")
        return Entry(options_of(stage), inspect.getdoc(module) or "", partial(execute_stage, stage))
    module_name, _, class_name = place.rpartition(".")
    command: type[Command] = getattr(importlib.import_module(module_name), class_name)
    return Entry(command, inspect.getdoc(command) or "", command.execute)


def main(argv: list[str] | None = None) -> int:
    """Entry of the ``vcage`` command; returns the exit code."""
    if argv is not None:
        return run_cli(_run, argv)
    prepare()
    return end_process(run_cli(_run, sys.argv[1:]))


def script_main(command: str) -> int:
    """Entry of a script that is one sub-command; its help shows the script's own name."""
    prepare()
    return end_process(run_cli(_run, [*command.split(), *sys.argv[1:]], Path(sys.argv[0]).name))


def _run(arguments: Sequence[str], prog: str = "") -> Result | None:
    """Run the command at the start of the arguments; None if only help was requested."""
    about = _about(arguments)
    if about:
        print_text(about.rstrip("\n"))
        return None
    require_fit()
    from vcage.cli.arguments import parse, words
    from vcage.cli.going_on import naming_stages

    CALLED.set("")
    name, rest = _named(arguments)
    command, program = load(name), name.split()
    about = vcage_command(*program, "--help")
    options = parse(command.options, rest, prog=prog or f"vcage {name}", text=command.text, about=about)
    if options is None:
        return None
    CALLED.set(vcage_command(*program, *words(options)))
    set_up(options.verbose, options.progress)
    with stray_output_on_stderr(), naming_stages(getattr(options, "run", None)):
        return command.execute(options)


def _is_group(word: str) -> bool:
    return any(name.startswith(f"{word} ") for name in COMMANDS)


def _about(arguments: Sequence[str]) -> str:
    """Return the help of all commands or a group of them on request, else nothing."""
    if arguments[:1] in (["-h"], ["--help"]):
        return help_text()
    if arguments[:1] == ["--version"]:
        return f"vcage {__version__}\n"
    if arguments[1:] in (["-h"], ["--help"]) and _is_group(arguments[0]):
        return help_text(arguments[0])
    return ""


def _named(arguments: Sequence[str]) -> tuple[str, Sequence[str]]:
    """Split a command's name, of one word or two, from the words after it."""
    if not arguments:
        raise UsageError("no command given", hint="see", command=vcage_command("--help"))
    words = 2 if _is_group(arguments[0]) else 1
    name = " ".join(arguments[:words])
    if name not in COMMANDS:
        raise UnknownName("command", name, [n for n in COMMANDS if n.startswith(f"{arguments[0]} ")] or COMMANDS)
    return name, arguments[words:]


def help_text(group: str = "") -> str:
    """Return the text of ``vcage --help``, or of a group of commands (``vcage assets --help``)."""
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
