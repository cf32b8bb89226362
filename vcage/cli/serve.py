"""``vcage serve``: the environments of a run behind a socket."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from vcage.base.options import FOLDER, NATURAL, POSITIVE, UNSAID, Flag
from vcage.cli.arguments import Command
from vcage.cli.output import Result

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Serve(Command):
    """Serve the environments of a run over a socket, for programs with other packages (such as lerobot-eval).

    Each connection gets an environment of its own, in a process of its own. The address is said on stderr when the
    server listens; Ctrl-C ends it. docs/evaluation.md has the messages; clients/lerobot_env_vcage is a client.

    examples:
      vcage serve runs/blocks --port 8100
      vcage serve runs/blocks --no-pictures --environment-state
    """

    run: Annotated[Path, FOLDER, Positional, arg(metavar="RUN")]
    """the run"""
    host: str = "127.0.0.1"
    """the interface to listen on; others than loopback let everyone in who reaches it"""
    port: Annotated[int, NATURAL] = 8100
    """the port; 0 takes a free one"""
    task: Annotated[int, NATURAL] = 0
    """number of the task, in a run that has several"""
    max_steps: Annotated[int | None, POSITIVE, UNSAID] = None
    """actions after which an episode ends (default: twice those of the run's longest accepted episode)"""
    randomise: Annotated[str | None, UNSAID] = None
    """ranges of the differences between episodes, as of collect (default: those of the run)"""
    no_pictures: Flag = False
    """observe no pictures; no renderer is needed then"""
    environment_state: Flag = False
    """observe the poses of the objects"""

    def execute(self) -> Result:
        """Serve until interrupted."""
        from vcage.evaluation.environment import EnvironmentOptions
        from vcage.evaluation.environment_server import environment_server

        options = EnvironmentOptions(
            chain=self.task,
            pictures=not self.no_pictures,
            environment_state=self.environment_state,
            max_steps=self.max_steps,
            randomise=self.randomise,
        )
        with environment_server(self.run, options, self.host, self.port) as server:
            host, port = server.socket.getsockname()[:2]
            logger.info("listening at ws://%s:%s", host, port)
            server.serve_forever()
        return Result()
