"""``vcage evaluate``: a policy in the scenes of a run."""

from __future__ import annotations

import logging
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from vcage.base.options import FOLDER, NATURAL, POSITIVE, UNSAID, Flag
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.evaluation.payload import Payload

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Evaluate(Command):
    """Let a policy act in the scenes of a run, in layouts and looks that its data does not have, and count successes.

    The policy is a server that speaks openpi's protocol, a factory in a Python module, the recorded actions (replay),
    or the scripts that collected the data (expert). Only layouts in which the expert succeeds are counted; the others
    are reported. An evaluation that was interrupted goes on when it is given again.

    examples:
      vcage evaluate runs/blocks --policy ws://127.0.0.1:8000 --episodes 50
      vcage evaluate runs/blocks --policy my_policies:make --no-pictures --environment-state --workers 2
      vcage evaluate runs/blocks --policy replay --episodes 3
    """

    run: Annotated[Path, FOLDER, Positional, arg(metavar="RUN")]
    """the run"""
    policy: Annotated[str, arg(metavar="POLICY")]
    """ws://HOST:PORT, MODULE:FACTORY, replay or expert"""
    out: Annotated[Path | None, FOLDER, UNSAID] = None
    """folder of evaluation.json (default: RUN/evaluations/<policy>)"""
    episodes: Annotated[int, POSITIVE] = 50
    """episodes to count"""
    first_seed: Annotated[int, NATURAL] = 100_000
    """seed of the first; the others count up"""
    actions: Annotated[int, POSITIVE] = 8
    """actions of an answer that are carried out before the policy is asked again"""
    payload: Annotated[Payload, UNSAID] = "generic"
    """fields of an observation: generic, or those of openpi's ALOHA configuration"""
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
    unproven: Flag = False
    """count all layouts, also those in which the expert fails"""
    workers: Annotated[int, POSITIVE] = 1
    """processes"""
    force: Flag = False
    """begin anew"""

    def execute(self) -> Result:
        """Evaluate."""
        from vcage.evaluation.environment import EnvironmentOptions
        from vcage.evaluation.evaluate import RECORD, Amount, evaluate
        from vcage.evaluation.rollouts import Order

        environment = EnvironmentOptions(
            chain=self.task,
            pictures=not self.no_pictures,
            environment_state=self.environment_state,
            max_steps=self.max_steps,
            randomise=self.randomise,
        )
        order = Order(self.run, self.policy, environment, self.payload, self.actions, solvable=not self.unproven)
        out = self.out or self.run / "evaluations" / re.sub(r"[^A-Za-z0-9.]+", "-", self.policy)
        with progress("evaluate") as show:
            record = evaluate(order, Amount(self.episodes, self.first_seed), out, self.workers, self.force, show)
        facts = record.facts()
        logger.info("%s: %s of %s episodes succeed", self.policy, facts["n_success"], facts["n_episodes"])
        return Result(output=out / RECORD, schema=record.SCHEMA, summary=facts)
