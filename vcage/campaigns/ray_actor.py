"""The actor that runs jobs on the nodes of a Ray cluster."""

from __future__ import annotations

from typing import Any

MARK = "node.partial-"
"""Begins the name of the file by which an actor shows that it has the folder of the campaign."""


def actor_class() -> type:
    """The class of the actors.

    Ray sends a class of a function by value, so that even a node without vcage can report its lack.
    """

    class Worker:
        """Runs jobs, one after the other, in a process of its own.

        Args:
            root: the folder of the campaign.
            command: that the user gave, for the error of a folder in use.
            version: of vcage in the driver.
        """

        def __init__(self, root: str, command: str, version: str):
            self._root, self._command, self._version, self._asked, self._mark = root, command, version, False, ""

        def look_around(self) -> dict[str, str]:
            """Report the id and name of this node, its version of vcage, and a mark: a file written to the folder of
            the campaign. ``fault`` says why it could not be written, or vcage not be loaded.
            """
            import importlib
            import platform
            import uuid
            from pathlib import Path

            self._asked = True
            seen = {
                "node": importlib.import_module("ray").get_runtime_context().get_node_id(),
                "host": platform.node(),
                "fault": "",
            }
            try:
                seen["version"] = importlib.import_module("vcage.base.version").__version__
            except ImportError as error:
                return seen | {"version": f"none ({error})", "mark": ""}
            try:
                if seen["version"] == self._version:  # loaded before a job's time is taken
                    importlib.import_module("vcage.episodes.preload")
                    importlib.import_module("vcage.campaigns.job")
            except (ImportError, OSError) as error:
                return seen | {"mark": "", "fault": f"vcage cannot be loaded there: {error}"}
            self._mark = f"{MARK}{uuid.uuid4().hex}"
            try:
                (Path(self._root) / self._mark).touch(exist_ok=False)
            except OSError as error:
                seen["fault"] = f"{self._root} cannot be written there: {error}"
            return seen | {"mark": self._mark}

        def leave(self) -> None:
            """Remove the file that :meth:`look_around` wrote."""
            import contextlib
            from pathlib import Path

            with contextlib.suppress(OSError):
                (Path(self._root) / self._mark).unlink()

        def run(self, work: Any, job: Any) -> Any:
            """Run a job; None if this process has not looked around yet."""
            if not self._asked:
                return None
            from pathlib import Path

            from vcage.base.commands import CALLED

            CALLED.set(self._command)
            return work(Path(self._root), job)

    return Worker
