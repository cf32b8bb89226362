"""The nodes of a Ray cluster, and the reasons for which some of them run no jobs of a campaign."""

from __future__ import annotations

import logging
import time
from pathlib import Path
from typing import Any

from vcage.base.commands import vcage_command
from vcage.base.errors import ConfigurationError

logger = logging.getLogger(__name__)


class Nodes:
    """Names the nodes that cannot run jobs, as long as others can.

    Args:
        ray: the module, connected.
        root: the folder of the campaign.
        version: of vcage in the driver.
        seen_within_s: time within which a file written by a node should appear here.
    """

    def __init__(self, ray: Any, root: Path, version: str, seen_within_s: float):
        self._ray, self._root, self._version, self._seen_within_s = ray, root, version, seen_within_s
        self._unfit: dict[str, str] = {}

    @property
    def processors(self) -> int:
        """Processors of the nodes that can run jobs."""
        return sum(self._fit().values())

    @property
    def selector(self) -> dict[str, str] | None:
        """The labels by which Ray keeps an actor off the others."""
        return {"ray.io/node-id": f"!in({','.join(self._unfit)})"} if self._unfit else None

    def is_left_out(self, node: str) -> bool:
        """True if a node can run no jobs."""
        return node in self._unfit

    def is_the_only_one(self, node: str) -> bool:
        """True if there is, and was, no other node."""
        return not self._unfit and not self._fit().keys() - {node}

    def leave_out(self, node: str, host: str, reason: str) -> None:
        """Name a node that can run no jobs.

        Args:
            node: its id.
            host: its name.
            reason: in words.

        Raises:
            ConfigurationError: it is the last one; names all.
        """
        if node not in self._unfit:
            self._unfit[node] = f"{host} ({node[:8]}): {reason}"
            logger.warning("no job is given to a node of the Ray cluster: %s", self._unfit[node])
        if self.processors == 0:
            raise ConfigurationError(
                f"no node of the Ray cluster can run this campaign: {'; '.join(self._unfit.values())}",
                hint=f"every node needs vcage {self._version}, and {self._root} as the same shared folder; to see what "
                "one lacks, run there",
                command=vcage_command("doctor"),
            )

    def reason_against(self, version: str, mark: str, fault: str) -> str:
        """The reason why a node can run no jobs, by the view of an actor on it; empty if it can.

        Args:
            version: of vcage there.
            mark: name of the file that the actor wrote.
            fault: that kept it from doing so, in words.
        """
        if version != self._version:
            return f"it has vcage {version}, not {self._version}"
        if fault:
            return fault
        end = time.monotonic() + self._seen_within_s
        while not (self._root / mark).exists():
            if time.monotonic() > end:
                return f"{self._root} is another folder there"
            time.sleep(0.2)
            self._root.touch()  # so that a file server's client reads the folder again
        (self._root / mark).unlink(missing_ok=True)
        return ""

    def _fit(self) -> dict[str, int]:
        """Nodes that can run jobs → their processors."""
        alive = [node for node in self._ray.nodes() if node["Alive"] and node["NodeID"] not in self._unfit]
        found = {node["NodeID"]: int(node["Resources"].get("CPU", 0)) for node in alive}
        return {node: count for node, count in found.items() if count > 0}
