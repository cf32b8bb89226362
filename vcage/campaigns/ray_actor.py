"""What runs on the nodes of a Ray cluster."""

from __future__ import annotations

from typing import Any


def actor_class() -> type:
    """The class of the actors.

    As it belongs to a function, Ray sends it whole, so that even a node without vcage can say what it lacks.
    """

    class Worker:
        """Runs jobs, one after the other, in a process of its own.

        Args:
            root: the folder of the campaign.
            command: that the user gave, for those who find a folder in use.
            version: of vcage in the driver.
        """

        def __init__(self, root: str, command: str, version: str):
            self._root, self._command, self._version, self._asked, self._mark = root, command, version, False, ""

        def look_around(self) -> dict[str, str]:
            """Say what there is on this node: its id and name, the version of vcage, and the name of a file that was
            written to the folder of the campaign, or what is wrong with that.
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
            if seen["version"] == self._version:  # loaded before a job's time is taken
                importlib.import_module("vcage.episodes.preload")
                importlib.import_module("vcage.campaigns.job")
            self._mark = f"node.partial-{uuid.uuid4().hex}"
            try:
                (Path(self._root) / self._mark).touch(exist_ok=False)
            except OSError as error:
                seen["fault"] = str(error)
            return seen | {"mark": self._mark}

        def leave(self) -> None:
            """Remove what was written for nobody to see."""
            import contextlib
            from pathlib import Path

            with contextlib.suppress(OSError):
                (Path(self._root) / self._mark).unlink()

        def run(self, work: Any, job: Any) -> Any:
            """Run a job; None if nobody has asked this process yet what it sees."""
            if not self._asked:
                return None
            from pathlib import Path

            from vcage.base.commands import CALLED

            CALLED.set(self._command)
            return work(Path(self._root), job)

    return Worker
