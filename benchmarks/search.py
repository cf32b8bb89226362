"""Time the search for sub-tasks in scenes of 40 objects, and count the reasons of its refusals.

No model is called: the offline rules judge which pairs are sensible.
"""

from __future__ import annotations

import logging
import re
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks._placement_scenes import BenchmarkScene, Stock
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.placement.place import place
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.scenes.starting_poses import MARGIN_M
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.scene import ObjectRecord
from vcage.tasks.ground import Ground
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import FoundSubtasks, find_subtasks
from vcage.tasks.workplace import Workplace

logger = logging.getLogger(__name__)

OBJECTS = 40
SEEDS = 5
REASONS = 8
"""Kinds of reasons that are named, the most frequent first."""


def run(quick: bool) -> dict[str, Any]:
    """A row for each scene: objects of the library drawn at random, in a workspace of their size.

    - ``candidates``: ways to try a template that were looked into; ``kept``: sub-tasks; ``refused``: refusals.
    - ``seconds``: wall time of the search in one process, the first look at each object's geometry included; of all
      rows the longest.
    - ``reasons``: how many refusals of all rows are of each kind.

    Args:
        quick: one scene, not five.
    """
    rows, reasons = [], Counter[str]()
    for seed in range(1 if quick else SEEDS):
        stock = Stock()  # a library of its own: what objects measure is not known from the scene before
        objects, ground = placed(stock, seed)
        stock.kinematics  # noqa: B018 loaded once by every run
        started = time.perf_counter()
        found = search(objects, ground, stock, seed)
        seconds = time.perf_counter() - started
        reasons += kinds_of_reasons(objects, found)
        rows.append(
            {
                "seed": seed,
                "objects": len(objects),
                "candidates": found.candidates,
                "kept": len(found.kept),
                "refused": len(found.refused),
                "seconds": round(seconds, 2),
            }
        )
        logger.info("seed %d: %.2f s", seed, seconds)
    return {
        "rows": rows,
        "seconds": max(row["seconds"] for row in rows),
        "reasons": dict(reasons.most_common(REASONS)),
    }


def search(objects: Sequence[SceneObject], ground: Ground, stock: Stock, seed: int) -> FoundSubtasks:
    """All sub-tasks of a scene, and why the others are none."""
    judge = OfflineReasoner().judge_pairs
    return find_subtasks(Workplace(objects, stock.kinematics, ground, np.random.default_rng(seed)), judge)


def placed(stock: Stock, seed: int) -> tuple[list[SceneObject], Ground]:
    """The objects of the first scene from ``seed`` on that can be placed, where the engine puts them; and the table."""
    while True:
        scene = stock.scene(OBJECTS, seed)
        rng = np.random.default_rng(seed)
        try:
            places = place(scene.items(stock.reach), scene.workspace, rng, margin=MARGIN_M)
        except InfeasibleScene:
            seed += 1000
            continue
        return _objects(scene, scene.poses(places)), Ground(scene.workspace[0], scene.workspace[1], scene.height)


def _objects(scene: BenchmarkScene, poses: dict[str, Pose]) -> list[SceneObject]:
    found = []
    for thing in scene.things:
        asset, pose = thing.asset, poses[thing.id]
        record = ObjectRecord(
            id=thing.id,
            asset=asset.name,
            variant=asset.variant.id,
            phrase=f"{asset.variant.colour} {asset.annotation.words.name}",
            role=thing.role,
            pose=PoseRecord.of(pose),
            aabb=box_record(asset.bounds, pose),
        )
        found.append(SceneObject(record, asset, pose))
    return found


def kinds_of_reasons(objects: Sequence[SceneObject], found: FoundSubtasks) -> Counter[str]:
    """Count refusals by reason, without the names and sizes in it."""
    phrases = sorted({o.record.phrase for o in objects}, key=len, reverse=True)
    names = re.compile("|".join(map(re.escape, phrases)))

    def kind(reason: str) -> str:
        bare = re.sub(r"'[^']*'", "…", names.sub("…", reason))
        return re.sub(r"\d+(\.\d+)?", "N", bare)

    return Counter(kind(refusal.reason) for refusal in found.refused)
