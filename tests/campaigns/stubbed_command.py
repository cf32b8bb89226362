"""``vcage campaign`` with the stub of :mod:`tests.campaigns.stubbed` in place of the chain, by each driver."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tests.campaigns.stubbed import run_stubbed
from vcage.base.errors import VcageError
from vcage.campaigns.driver import run_here
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.on_ray import run_on_ray
from vcage.campaigns.plan import Plan
from vcage.campaigns.schedule import Schedule, left_over
from vcage.campaigns.shard import Shard


def main() -> int:
    """Run the campaign that the command line names; the exit code is that of what is left."""
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("plan", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--shard", default="0/1")
    parser.add_argument("--ray")
    given = parser.parse_args()
    folder = CampaignFolder(given.out)
    folder.begin(Plan.load(given.plan))
    try:
        error = left_over(_driven(folder, given))
    except VcageError as found:
        error = found
    if error is not None:
        print(error.as_line(), file=sys.stderr)
    return 0 if error is None else error.exit_code


def _driven(folder: CampaignFolder, given: argparse.Namespace) -> Schedule:
    if given.ray:
        return run_on_ray(folder, given.ray, given.workers, work=run_stubbed)
    shard = Shard(*map(int, given.shard.split("/")))
    return run_here(folder, given.workers, shard, work=run_stubbed)


if __name__ == "__main__":
    sys.exit(main())
