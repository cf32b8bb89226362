"""Poses of a hand at which its fingers close on an object where they are meant to."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.kinematics import TILTS
from vcage.tasks.grasps import GraspPose, approach_opening, grasp_poses
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class ClosingSettings:
    """How the material between two fingers is measured.

    Args:
        wider_m: by which a tilted hand may meet wider material than a straight one. Beyond, its fingers close on
            another part, and the object turns between them. A hammer's handle is 7 mm wider there and is held; the
            guard of a scanner is 10 mm wider and turns. For the fingers of aloha_agilex, at 60 degrees 24 of the
            library's 436 contact points are left out.
        across, along: lines that are measured over the width and the length of a finger.
        edge_m: of the finger, beyond which nothing is measured: an edge that grazes holds nothing.
    """

    wider_m: float = 0.008
    across: int = 3
    along: int = 7
    edge_m: float = 0.001


SETTINGS = ClosingSettings()


def hand_poses(
    thing: SceneObject, contact: ContactPoint, gripper: Gripper, tilts: tuple[float, ...] = TILTS
) -> list[GraspPose]:
    """The poses of :func:`~vcage.tasks.grasps.grasp_poses` at which the fingers close at the contact point.

    They come in pairs: the second is flipped about the approach.

    Args:
        thing: where it stands.
        contact: of its body.
        gripper: of the hand.
        tilts: see there; the first is that of a straight hand.
    """
    poses = list(grasp_poses(thing.pose, contact, gripper, thing.box.bottom, tilts))
    opening = approach_opening(thing.asset.grasp_width(contact), gripper)
    pairs = list(zip(poses[::2], poses[1::2], strict=True))
    widths = [closed_width(thing.asset, pair[0].in_object, gripper, opening) for pair in pairs]
    kept = [pair for pair, width in zip(pairs, widths, strict=True) if width <= widths[0] + SETTINGS.wider_m]
    return [pose for pair in kept for pose in pair]


def closed_width(asset: Asset, hand: Pose, gripper: Gripper, opening: float) -> float:
    """Distance between two fingers when both meet an object, metres; 0 where there is nothing between them.

    Args:
        asset: of the object.
        hand: gripper frame in the object frame.
        gripper: of the hand.
        opening: from which the fingers close, metres.
    """
    side = gripper.finger_width / 2 - SETTINGS.edge_m
    length = SETTINGS.edge_m - gripper.finger_length, gripper.tip_depth - SETTINGS.edge_m
    grid = product(np.linspace(-side, side, SETTINGS.across), np.linspace(*length, SETTINGS.along))
    return asset.closed_width(hand.apply([[x, 0.0, z] for x, z in grid]), hand.rotation()[:, 1], opening)
