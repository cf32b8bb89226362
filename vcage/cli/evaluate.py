"""``vcage evaluate``: a policy in the scenes of a run."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import arg

from vcage.base.options import FOLDER, NATURAL, POSITIVE, UNSAID, Flag, several, value
from vcage.cli.environment_command import EnvironmentCommand
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.evaluation.factors import FACTORS, Factor, require_seen
from vcage.evaluation.payload import Payload

if TYPE_CHECKING:
    from vcage.evaluation.evaluate import Amount
    from vcage.evaluation.rollouts import Order
    from vcage.schema.evaluation import Evaluation

logger = logging.getLogger(__name__)


def _name(text: str) -> str:
    """A name that a folder may have."""
    if not any(letter.isascii() and letter.isalnum() for letter in text):
        raise ValueError(f"{text!r} is no name: it needs a letter or a digit of ASCII")
    return text


@dataclass(frozen=True, kw_only=True)
class Evaluate(EnvironmentCommand):
    """Let a policy act in the scenes of a run, in layouts and looks that its data does not have, and count successes.

    The policy is a server that speaks openpi's protocol, a factory in a Python module, the recorded actions (replay),
    or the scripts that collected the data (expert). Only layouts in which the expert succeeds are counted; the others
    are reported. An evaluation that was interrupted goes on when it is given again.

    examples:
      vcage evaluate runs/blocks --policy ws://127.0.0.1:8000 --episodes 50
      vcage evaluate runs/blocks --policy my_policies:make --no-pictures --environment-state --workers 2
      vcage evaluate runs/blocks --policy replay --episodes 3
      vcage evaluate runs/blocks --policy new:make --against runs/blocks/evaluations/old-make
      vcage evaluate runs/blocks --policy my_policies:make --vary light camera clutter
    """

    policy: Annotated[str, arg(metavar="POLICY")]
    """ws://HOST:PORT, MODULE:FACTORY, replay or expert"""
    name: Annotated[str | None, value(_name, "NAME"), UNSAID] = None
    """of the policy, in its record and folder (default: POLICY): under one name a server may move to another port"""
    out: Annotated[Path | None, FOLDER, UNSAID] = None
    """folder of evaluation.json (default: RUN/evaluations/<name>)"""
    episodes: Annotated[int, POSITIVE] = 50
    """episodes to count"""
    first_seed: Annotated[int, NATURAL] = 100_000
    """seed of the first; the others count up"""
    actions: Annotated[int, POSITIVE] = 8
    """actions of an answer that are carried out before the policy is asked again"""
    payload: Annotated[Payload, UNSAID] = "generic"
    """fields of an observation: generic, or those of openpi's ALOHA configuration"""
    unproven: Flag = False
    """count all layouts, also those in which the expert fails"""
    against: Annotated[Path | None, arg(metavar="OTHER"), UNSAID] = None
    """another evaluation from the same starts, or its folder: who succeeds where, and McNemar's test"""
    vary: Annotated[tuple[Factor, ...], several("{" + ",".join(FACTORS) + "} ...", choices=FACTORS), UNSAID] = ()
    """evaluate once more for each of these, which alone is drawn as widely as the ranges full do; layout: where
    layouts are drawn, the optimised one, and the reverse"""
    videos: Annotated[int, NATURAL] = 8
    """episodes on the page, above all failures; none where nothing here can draw"""
    workers: Annotated[int, POSITIVE] = 1
    """processes"""
    force: Flag = False
    """begin anew, as when the policy has changed behind its name"""

    def execute(self) -> Result:
        """Evaluate, compare, and write the page."""
        from vcage.evaluation.comparison import compare, read_other
        from vcage.evaluation.evaluate import RECORD, Amount, evaluate
        from vcage.evaluation.filming import film
        from vcage.evaluation.report import PAGE, write_page

        orders, amount = self._orders(), Amount(self.episodes, self.first_seed)
        other = None if self.against is None else read_other(self.against)
        _require_possible(orders.values(), amount, other)
        out = self.out or self._usual_folder()
        folders = {"": out, **{name: out / f"vary-{name}" for name in self.vary}}
        records, videos = {}, {}
        for name, order in orders.items():
            with progress(f"evaluate with other {name}" if name else "evaluate") as show:
                records[name] = evaluate(order, amount, folders[name], self.workers, self.force, show)
                videos[name] = film(order, records[name], folders[name], self.videos, show)
        record = records[""]
        comparisons = [compare(record, records[name], name) for name in self.vary]
        if other is not None:
            comparisons.append(compare(record, other, f"{other.policy} ({self.against})"))
        for name in self.vary:
            write_page(folders[name], records[name], videos[name])
        write_page(out, record, videos[""], comparisons, {name: f"vary-{name}/{PAGE}" for name in self.vary})
        facts = record.facts()
        logger.info("%s: %s of %s episodes succeed", record.policy, facts["n_success"], facts["n_episodes"])
        facts |= {"compared": [comparison.facts() for comparison in comparisons], "page": str(out / PAGE)}
        return Result(output=out / RECORD, schema=record.SCHEMA, summary=facts)

    def _usual_folder(self) -> Path:
        return self.run / "evaluations" / re.sub(r"[^A-Za-z0-9.]+", "-", self.name or self.policy)

    def _orders(self) -> dict[str, Order]:
        """The evaluation, by an empty name, and one more for each factor that is varied."""
        from vcage.evaluation.rollouts import Order

        environment = self.environment()
        order = Order(
            self.run, self.policy, environment, self.payload, self.actions, solvable=not self.unproven, name=self.name
        )
        varied = {name: replace(order, environment=replace(environment, vary=name)) for name in self.vary}
        return {"": order, **varied}


def _require_possible(orders: Iterable[Order], amount: Amount, other: Evaluation | None) -> None:
    """Require that each evaluation can be done, and be compared with the other, before any is begun."""
    from vcage.evaluation.comparison import require_same_starts, require_shared_seeds
    from vcage.evaluation.evaluate import planned

    for order in orders:
        if order.environment.vary is not None:
            require_seen(order.environment.vary, order.environment.pictures)
        plan = planned(order, amount)
        if other is not None:
            require_same_starts(plan, other)
            if not plan.starts["recorded"]:
                require_shared_seeds(other, amount.first_seed, amount.episodes)
