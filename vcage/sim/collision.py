"""Collision of an arm at given joints: its links and its held object against objects, table and other arms."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import PhysicalModel
from vcage.schema.robot import Robot
from vcage.schema.scene import Table
from vcage.sim.bodies import Body
from vcage.sim.joints import part_name, part_names
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.poses import to_sapien
from vcage.sim.shapes import ConvexShape, box_shape, model_shapes
from vcage.sim.surroundings import THICKNESS

if TYPE_CHECKING:
    import sapien
    from mplib.pymp.collision_detection import fcl

    from vcage.sim.world import World


@dataclass(frozen=True)
class CollisionSettings:
    """Distances that count as a collision.

    Args:
        overlap_m: allowed overlap: objects rest on each other, and fingers lie against the held object.
        clearance_m: least distance from the other arms, and on free ways from objects: on ``aloha_agilex`` a hand in
            motion is 4 mm behind its target.
        hand_clearance_m: least distance of links other than fingers from all that they may not touch: where fingers
            close on a thing, the palm stays off what lies beside it. It may be nearer to the thing itself, which short
            fingers hold deep.
    """

    overlap_m: float = 0.002
    clearance_m: float = 0.005
    hand_clearance_m: float = 0.003


SETTINGS = CollisionSettings()


@dataclass(frozen=True)
class Held:
    """An object between the fingers.

    Args:
        object_id: its id.
        model: its geometry.
        in_gripper: object frame in the gripper frame.
        joints: positions of its moving parts; all at 0 when empty.
        clearance: free height below it, metres.
        contents: ids and bodies of objects that lie in it and move along; their poses are in its frame.
    """

    object_id: str
    model: PhysicalModel
    in_gripper: Pose
    joints: tuple[float, ...] = ()
    clearance: float = 0.0
    contents: tuple[tuple[str, Body], ...] = ()

    @property
    def parts(self) -> list[str]:
        """The obstacle names of all parts of the object and of its contents."""
        models = [(self.object_id, self.model), *((name, body.model) for name, body in self.contents)]
        return [part for name, model in models for part in part_names(name, model)]

    def shapes(self, gripper: sapien.Pose) -> Iterator[tuple[str, ConvexShape, sapien.Pose]]:
        """(owner's id, shape, frame) of each shape of the object and its contents, with the gripper at a pose."""
        pose = gripper * to_sapien(self.in_gripper)
        yield from ((self.object_id, shape, pose * local) for _, shape, local in model_shapes(self.model, self.joints))
        for name, body in self.contents:
            at = pose * to_sapien(body.pose)
            yield from ((name, shape, at * local) for _, shape, local in model_shapes(body.model, body.joints))


@dataclass(frozen=True)
class Contact:
    """Two things that would overlap, or come too near."""

    moving: str
    other: str


class _Solids:
    """Shapes with poses, and their bounding spheres for a quick first test; FCL objects are made on demand."""

    def __init__(self, items: Iterable[tuple[str, ConvexShape, sapien.Pose]]):
        items = list(items)
        self.names = [name for name, _, _ in items]
        self._shapes = [shape for _, shape, _ in items]
        self._frames = [pose * shape.local for _, shape, pose in items]
        self._objects: dict[int, fcl.CollisionObject] = {}
        centres = np.array([shape.centre for shape in self._shapes]).reshape(-1, 3)
        self.centres = _placed(centres, self._frames)
        self.radii = np.array([shape.radius for shape in self._shapes])

    def object(self, index: int) -> fcl.CollisionObject:
        """A shape at its pose."""
        if index not in self._objects:
            self._objects[index] = self._shapes[index].placed(self._frames[index])
        return self._objects[index]


def _placed(points: np.ndarray, frames: Sequence[sapien.Pose]) -> np.ndarray:
    """(n, 3) each point brought to the world by its own frame."""
    p = np.array([frame.p for frame in frames], dtype=np.float64).reshape(-1, 3)
    w, x, y, z = np.array([frame.q for frame in frames], dtype=np.float64).reshape(-1, 4).T
    a, b, c = points.T
    # t = 2 v × point, then point + w t + v × t (v the quaternion's vector part); np.cross costs ten times as much.
    i, j, k = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    turned = a + w * i + y * k - z * j, b + w * j + z * i - x * k, c + w * k + x * j - y * i
    return p + np.stack(turned, axis=1)


class CollisionScene:
    """Everything around one arm.

    Args:
        robot: whose arm it is.
        arm: its name.
        table: a solid slab.
        bodies: objects by id; their parts are obstacles named ``<id>`` (the body) and ``<id>/<link>``.
        joints: (n,) of the other arms by name; home for arms that are not given.
    """

    def __init__(
        self,
        robot: Robot,
        arm: str,
        table: Table,
        bodies: Mapping[str, Body],
        joints: Mapping[str, np.ndarray] | None = None,
    ):
        import sapien

        self.kinematics = kinematics_of(robot.arms[arm])
        self._to_base = to_sapien(robot.arms[arm].base.pose().inverse())
        slab = sapien.Pose([*table.centre, table.height - THICKNESS / 2])
        items = [("table", box_shape([*table.size, THICKNESS]), slab)]
        for name, body in bodies.items():
            pose, shapes = to_sapien(body.pose), model_shapes(body.model, body.joints)
            items += [(part_name(name, part), shape, pose * local) for part, shape, local in shapes]
        standing = len(items)
        for other, record in robot.arms.items():
            if other != arm:
                items += _links_of(other, kinematics_of(record), (joints or {}).get(other))
        self._obstacles = _Solids((name, shape, self._to_base * pose) for name, shape, pose in items)
        self._of_arms = np.arange(len(items)) >= standing
        self._obstacles.radii += max(SETTINGS.clearance_m, SETTINGS.hand_clearance_m)
        links = {name for name, _ in self.kinematics.link_shapes}
        self._other_links = links - self.kinematics.finger_links

    @classmethod
    def of_world(cls, world: World, arm: str, changed: Mapping[str, Body] | None = None) -> CollisionScene:
        """The present surroundings of an arm in a world.

        Args:
            world: with a robot.
            arm: its name.
            changed: planned bodies of objects by id, instead of the present ones.

        Raises:
            ValueError: the world has no robot.
        """
        if world.robot is None:
            raise ValueError("this world has no robot")
        bodies = {name: world.body(name) for name in world.object_ids} | dict(changed or {})
        others = {name: control.joints for name, control in world.arms.items() if name != arm}
        return cls(world.robot, arm, world.table, bodies, others)

    def first_contact(
        self,
        q: np.ndarray,
        opening: float = 1.0,
        held: Held | None = None,
        ignore: Collection[str] = (),
        fingers_may_touch: Collection[str] = (),
        beside: Collection[str] | None = None,
    ) -> Contact | None:
        """The first overlap of more than ``overlap_m`` with the arm at ``q``, or None.

        Of other arms, links nearer than ``clearance_m`` count; and so do links other than fingers that are nearer
        than ``hand_clearance_m`` to anything but what the fingers may touch.

        Args:
            q: (n,) arm joints, rad.
            opening: of the gripper, 0 closed to 1 open.
            held: the object in the gripper.
            ignore: names of obstacles that may be touched: ``<id>`` for an object's body, ``<id>/<link>`` for a
                moving part, ``table``, or ``<arm>/<link>``.
            fingers_may_touch: names of obstacles that the fingers may touch, and no other link.
            beside: names of obstacles that may be near; all others count as other arms do. Not given, all may be.
        """
        moving, ranks = self._moving(q, opening, held)
        skip = {*ignore, *held.parts} if held else set(ignore)
        return self._with_obstacles(moving, ranks, skip, fingers_may_touch, beside) or self._with_itself(moving, ranks)

    def beside(self, q: np.ndarray, opening: float = 1.0, held: Held | None = None) -> frozenset[str]:
        """Names of the obstacles nearer than ``clearance_m`` to the arm or what it holds.

        Args:
            q, opening, held: as of :meth:`first_contact`.
        """
        moving, ranks = self._moving(q, opening, held)
        close = _spheres_meet(moving, self._obstacles) & (ranks > 0)[:, None]
        return frozenset(
            self._obstacles.names[j]
            for i, j in np.argwhere(close).tolist()
            if near_to(moving.object(i), self._obstacles.object(j), SETTINGS.clearance_m)
        )

    def _moving(self, q: np.ndarray, opening: float, held: Held | None) -> tuple[_Solids, np.ndarray]:
        """The links and what is held, and (n,) the rank of each link in the arm."""
        poses = self.kinematics.base_poses(q, opening)
        parts = [(link, shape, poses[link]) for link, shape in self.kinematics.link_shapes]
        ranks = self.kinematics.link_ranks
        if held is not None:
            tool = self.kinematics.base_pose_of_tool(q)
            at = [tool, self._below(held.clearance) * tool] if held.clearance else [tool]
            carried = [solid for gripper in at for solid in held.shapes(gripper)]
            parts, ranks = parts + carried, np.append(ranks, np.full(len(carried), ranks.max()))
        return _Solids(parts), ranks

    def _below(self, distance: float) -> sapien.Pose:
        """Straight down in the world, in the frame of the arm's base, metres."""
        import sapien

        return self._to_base * sapien.Pose([0.0, 0.0, -distance]) * self._to_base.inv()

    def _with_obstacles(
        self,
        moving: _Solids,
        ranks: np.ndarray,
        skip: Collection[str],
        fingers_may_touch: Collection[str],
        beside: Collection[str] | None,
    ) -> Contact | None:
        fingers = self.kinematics.finger_links
        near = _spheres_meet(moving, self._obstacles) & (ranks > 0)[:, None]  # the base never moves
        for i, j in np.argwhere(near).tolist():
            name = self._obstacles.names[j]
            taken = name in fingers_may_touch
            if name in skip or (taken and moving.names[i] in fingers):
                continue
            kept_off = self._of_arms[j] or (beside is not None and name not in beside)
            keeps_clear = not taken and moving.names[i] in self._other_links
            clearance = SETTINGS.clearance_m if kept_off else SETTINGS.hand_clearance_m if keeps_clear else None
            one, other = moving.object(i), self._obstacles.object(j)
            if overlap(one, other) if clearance is None else near_to(one, other, clearance):
                return Contact(moving.names[i], name)
        return None

    def _with_itself(self, moving: _Solids, ranks: np.ndarray) -> Contact | None:
        apart = ranks[:, None] - ranks[None] >= self.kinematics.arm.self_collision_gap
        near = _spheres_meet(moving, moving) & apart
        for i, j in np.argwhere(near).tolist():
            if overlap(moving.object(i), moving.object(j)):
                return Contact(moving.names[i], moving.names[j])
        return None


def overlapping(bodies: Mapping[str, Body]) -> list[tuple[str, str]]:
    """Pairs of objects that overlap by more than ``overlap_m``, in the order given.

    Args:
        bodies: objects by id.
    """
    solids = {name: _solids_of(name, body) for name, body in bodies.items()}
    found = []
    for (first, a), (second, b) in itertools.combinations(solids.items(), 2):
        if _meet(a, b, overlap):
            found.append((first, second))
    return found


def first_near(body: Body, others: Mapping[str, Body], distance: float) -> str | None:
    """The first of other objects that is nearer to an object than a distance, by id; None where all are farther.

    Args:
        body: the object.
        others: by id.
        distance: metres.
    """
    own = _solids_of("", body)
    own.radii += distance
    for name, other in others.items():
        if _meet(own, _solids_of(name, other), partial(near_to, distance=distance)):
            return name
    return None


def _solids_of(name: str, body: Body) -> _Solids:
    """All parts of an object where it is, each with its id."""
    pose = to_sapien(body.pose)
    return _Solids((name, shape, pose * local) for _, shape, local in model_shapes(body.model, body.joints))


def meets_box(body: Body, size: Iterable[float], at: Pose) -> bool:
    """True if an object overlaps a box by more than ``overlap_m``.

    Args:
        body: the object.
        size: of the box (x, y, z), metres.
        at: of the middle of the box, in the world.
    """
    return _meet(_solids_of("", body), _Solids([("box", box_shape(size), to_sapien(at))]), overlap)


def _meet(a: _Solids, b: _Solids, meets: Callable[[fcl.CollisionObject, fcl.CollisionObject], bool]) -> bool:
    """True if two solids, one of each kind, meet; the rest is ruled out by bounding spheres."""
    return any(meets(a.object(i), b.object(j)) for i, j in np.argwhere(_spheres_meet(a, b)).tolist())


def overlap(a: fcl.CollisionObject, b: fcl.CollisionObject) -> bool:
    """True if two solids overlap by more than ``overlap_m``."""
    from mplib.pymp.collision_detection import fcl

    result = fcl.collide(a, b, _first_contact_only())
    return result.is_collision() and abs(result.get_contact(0).penetration_depth) > SETTINGS.overlap_m


def near_to(a: fcl.CollisionObject, b: fcl.CollisionObject, distance: float) -> bool:
    """True if two solids overlap, or are nearer to each other than a distance, metres."""
    from mplib.pymp.collision_detection import fcl

    # FCL gives some overlapping boxes a positive distance of millimetres.
    return (
        fcl.distance(a, b, _distance_only()).min_distance < distance
        or fcl.collide(a, b, _overlap_only()).is_collision()
    )


@functools.cache
def _distance_only() -> fcl.DistanceRequest:
    from mplib.pymp.collision_detection import fcl

    return fcl.DistanceRequest()


@functools.cache
def _overlap_only() -> fcl.CollisionRequest:
    from mplib.pymp.collision_detection import fcl

    return fcl.CollisionRequest()


@functools.cache
def _first_contact_only() -> fcl.CollisionRequest:
    from mplib.pymp.collision_detection import fcl

    return fcl.CollisionRequest(num_max_contacts=1, enable_contact=True)


def _spheres_meet(a: _Solids, b: _Solids) -> np.ndarray:
    """(len(a), len(b)) bool, True for shapes whose bounding spheres meet."""
    between = a.centres[:, None] - b.centres[None]
    return np.einsum("ijk,ijk->ij", between, between) < (a.radii[:, None] + b.radii[None]) ** 2


def _links_of(
    arm: str, kinematics: ArmKinematics, joints: np.ndarray | None
) -> list[tuple[str, ConvexShape, sapien.Pose]]:
    base = to_sapien(kinematics.arm.base.pose())
    poses = kinematics.base_poses(kinematics.home if joints is None else joints, 1.0)
    return [(f"{arm}/{link}", shape, base * poses[link]) for link, shape in kinematics.link_shapes]
