"""``vcage serve``: the environments of a run behind a socket."""

from __future__ import annotations

import logging
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Annotated

from vcage.base.options import NATURAL
from vcage.cli.environment_command import EnvironmentCommand
from vcage.cli.output import Result

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Serve(EnvironmentCommand):
    """Serve the environments of a run over a socket, for programs with other packages (such as lerobot-eval).

    Each connection gets an environment of its own, in a process of its own. The address is said on stderr when the
    server listens. Ctrl-C ends it, and what was served is said. docs/evaluation.md has the messages;
    clients/lerobot_env_vcage is a client.

    examples:
      vcage serve runs/blocks --port 8100
      vcage serve runs/blocks --no-pictures --environment-state
    """

    host: str = "127.0.0.1"
    """the interface to listen on; others than loopback let everyone in who reaches it"""
    port: Annotated[int, NATURAL] = 8100
    """the port; 0 takes a free one"""

    def execute(self) -> Result:
        """Serve until Ctrl-C, the way to end it."""
        from vcage.evaluation.environment_server import Served, environment_server

        served = Served()
        with environment_server(self.run, self.environment(), self.host, self.port, served) as server:
            host, port = server.socket.getsockname()[:2]
            logger.info("listening at ws://%s:%s", host, port)
            with suppress(KeyboardInterrupt):
                server.serve_forever()
        logger.info("served %s", served)
        return Result(summary={"served": asdict(served)})
