"""Check 5: the robot opens and closes each joint, or presses it and it comes back."""

from __future__ import annotations

import numpy as np

from vcage.apps.proof.trials import OBJECT, TrialPlaces, scene_object, tried, world_with
from vcage.base.errors import VcageError
from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint, MovingLink
from vcage.schema.proof import ProofCheck
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.task import Task


def check_joint(asset: Asset, link: MovingLink, places: TrialPlaces, tries: int, seed: int) -> ProofCheck:
    """Try one joint at random places of the table.

    Args:
        asset: the tested asset.
        link: the part that the joint moves.
        places: table and robot.
        tries: how often.
        seed: of the places.
    """
    index = [other.name for other in asset.model.links].index(link.name)
    rng = np.random.default_rng([seed, 2000 + index])
    contacts = [contact for contact in asset.annotation.contact_points if contact.link == link.name]
    if not contacts:
        reason = f"no contact point is on {link.name}: nothing to operate it by"
        return ProofCheck(check="joint", subject=link.name, passed=False, tries=0, reasons=[reason])

    def trial(number: int) -> str | None:
        return _try(asset, index, contacts[number % len(contacts)], places.for_operating(asset, rng), places)

    measured = {"range": link.joint.upper - link.joint.lower, "handles": len(contacts)}
    return tried("joint", link.name, tries, trial, measured)


def _try(asset: Asset, index: int, contact: ContactPoint, pose: Pose, places: TrialPlaces) -> str | None:
    world = world_with(asset, pose, places)
    world.settle()
    joint = asset.model.links[index].joint
    watch = _Watch(world, index)
    try:
        _operate(world, asset, contact, joint.far_end)
        if contact.use == "grasp":
            opened = watch.share(joint.far_end)
            if opened < THRESHOLDS.opened_share:
                return f"opened by {100 * opened:.0f} % only"
            _operate(world, asset, contact, 0.0)
    except VcageError as error:
        return error.message
    if watch.furthest / abs(joint.far_end) < THRESHOLDS.opened_share:
        return f"pressed by {100 * watch.furthest / abs(joint.far_end):.0f} % only"
    world.step(PHYSICS_HZ // 2)
    left = watch.share(joint.far_end)
    return None if left < THRESHOLDS.closed_share else f"left open by {100 * left:.0f} %"


def _operate(world: World, asset: Asset, contact: ContactPoint, target: float) -> None:
    """Bring the joint to ``target`` with a hand that starts and ends at home."""
    task = Task(world, {OBJECT: scene_object(asset, world.object_pose(OBJECT))}, {})
    task.operate(OBJECT, contact.id, target)
    world.settle(max_steps=PHYSICS_HZ)


class _Watch:
    """Follows one joint of the object.

    Args:
        index: of the joint.
    """

    def __init__(self, world: World, index: int):
        self._world, self._index = world, index
        self.furthest = 0.0
        world.before_step.append(self._note)

    def share(self, far_end: float) -> float:
        """Return the joint's position as a share of its way to the far end."""
        return float(self._world.object_joints(OBJECT)[self._index]) / far_end

    def _note(self, world: World) -> None:
        self.furthest = max(self.furthest, abs(float(world.object_joints(OBJECT)[self._index])))
