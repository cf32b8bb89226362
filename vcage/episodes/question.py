"""The question to the critic after a sub-task: its cameras, and its facts about the scene."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, Pose, box_corners, look_at
from vcage.goals.presented import TOWARDS_CUSTOMER
from vcage.models.protocols import THIN_SUPPORT_M, CriticQuestion, StoodUp
from vcage.plans.actions import HOLDING
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Statement, Subtask
from vcage.sim.drawer import Drawing, Window
from vcage.sim.joints import link_poses
from vcage.sim.robots import load_robot
from vcage.tasks.hand_views import HandCameras
from vcage.tasks.hanging import hung_poses
from vcage.tasks.hitting import hitting_poses
from vcage.tasks.inserting import inserted_poses
from vcage.tasks.reading import SETTINGS as READING
from vcage.tasks.reading import reading_poses
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.setting import Seen
from vcage.tasks.slots import nested_bottom
from vcage.tasks.wiping import farthest, wiping_ways
from vcage.vision.protocols import Reference, View

TOP, CUSTOMER = "top", "customer"
"""The scene's camera above the table, and one where the customer stands."""


@dataclass(frozen=True)
class CameraSettings:
    """The camera on the customer's side, and when it is used.

    Args:
        covered_share: share of a support's area, from above, that an object on it may cover before the customer's
            side is looked at too: from above, a stack looks like its upper block.
        nested_share: the same of an object in a container: what covers more may nest in it, and hide it.
        low_m: a top that is lower is as high as the table.
        in_the_air_m: how much higher the camera looks where something changes hands.
        away_m, above_m: how far beyond the table's far edge and above its top the camera is.
        fovy_rad: its vertical field of view.
    """

    covered_share: float = 0.3
    nested_share: float = 0.5
    low_m: float = 0.01
    in_the_air_m: float = 0.2
    away_m: float = 0.75
    above_m: float = 0.5
    fovy_rad: float = 0.75


SETTINGS = CameraSettings()


def cameras(scene: Scene, goals: Collection[Goal]) -> dict[str, Camera]:
    """The cameras through which the critic looks at a sub-task, by name; their calibration is known."""
    found = {TOP: scene.top_camera.camera()}
    if any(goal.kind.shown.customer or _hides_its_support(scene, goal) for goal in goals):
        (x, y), height = scene.table.rectangle.mean(axis=0), scene.table.height
        edge = np.array([x, y, height]) + TOWARDS_CUSTOMER * scene.table.size[1] / 2
        eye = edge + TOWARDS_CUSTOMER * SETTINGS.away_m + np.array([0.0, 0.0, SETTINGS.above_m])
        top = scene.top_camera
        at = [x, y, height + SETTINGS.in_the_air_m * any(goal.kind.shown.in_the_air for goal in goals)]
        found[CUSTOMER] = Camera(top.width, top.height, SETTINGS.fovy_rad, look_at(eye, at, up=(0, 0, 1)))
    return found


def _hides_its_support(scene: Scene, goal: Goal) -> bool:
    """True when an object covers much of its support, seen from above, and the side of the support can be seen."""
    boxes = {o.id: np.ptp(np.array(o.aabb), axis=0) for o in scene.objects}
    if goal.relation not in HOLDING or goal.part is not None or goal.reference not in boxes:
        return False
    thing, support = boxes[goal.subject], boxes[goal.reference]
    share = SETTINGS.covered_share if goal.relation == "on" else SETTINGS.nested_share
    covers = np.prod(thing[:2]) > share * np.prod(support[:2])
    return bool(support[2] > THIN_SUPPORT_M and covers)


@dataclass(frozen=True)
class Asking:
    """The question about a sub-task, except the parts that follow from the scene.

    Args:
        text, goals: the sub-task in words and in the closed vocabulary.
        seen: pictures (H, W, 3) uint8 RGB by content and by camera (see :data:`vcage.tasks.setting.Seen`).
        background: the top view of the empty table.
        requires: facts true before, by the plan: which drawers are open.
        grasped: id of the object the robot was to grasp, if it is not the goals' object.
        statements: facts to preserve.
    """

    text: str
    goals: Sequence[Goal]
    seen: Seen
    background: np.ndarray | None = None
    requires: Sequence[Goal] = ()
    grasped: str | None = None
    statements: Sequence[Statement] = ()

    @classmethod
    def of(cls, subtask: Subtask, seen: Seen, background: np.ndarray | None) -> Asking:
        """About a sub-task in its own words."""
        facts = (subtask.requires, subtask.grasped, subtask.statements)
        return cls(subtask.text, subtask.goals, seen, background, *facts)

    @property
    def hash(self) -> str:
        """Hex SHA-256 of all of it."""
        records = [record.model_dump_json() for record in (*self.goals, *self.requires, *self.statements)]
        words = (self.text, records, self.grasped)
        digest = hashlib.sha256(repr(words).encode())
        shown = [(f"{when} {name}", p) for when, by in sorted(self.seen.items()) for name, p in sorted(by.items())]
        for name, picture in [*shown, *([] if self.background is None else [("background", self.background)])]:
            digest.update(f"{name} {picture.shape}".encode() + np.ascontiguousarray(picture).tobytes())
        return digest.hexdigest()


def verdict(context: StageContext, scene: Scene, asking: Asking) -> Verdict:
    """Ask the critic about one sub-task.

    Args:
        context: with the critic, and how the objects look.
        scene: where it was done.
        asking: the question.

    Raises:
        VcageError: the critic cannot be asked, or gives no answer of use.
    """
    answer = context.models.critic.judge(_question(context, scene, asking))
    return answer.model_copy(update={"question": asking.hash})


def _question(context: StageContext, scene: Scene, asking: Asking) -> CriticQuestion:
    goals, seen = asking.goals, asking.seen
    objects, taken_by = {o.id: o for o in context.objects(scene)}, cameras(scene, goals)
    opened = _opened(goals, asking.requires, asking.statements)
    if asking.background is not None:
        _view(asking.background, taken_by[TOP], "empty table")

    def draw(object_id: str, pose: Pose, camera: Camera, window: Window, shares: Mapping[str, float]) -> Drawing:
        return context.drawing(scene.object(object_id), pose, camera, window, shares)

    def readings(moved: str, at: Pose, still: str, there: Pose) -> Iterator[Pose]:
        mover, other = objects[moved].moved(at), objects[still].moved(there)
        return chain.from_iterable(reading_poses(mover, other, scene.table.height, rise) for rise in READING.raises_m)

    def strikes(tool: str, at: Pose, thing: str, there: Pose) -> Iterator[Pose]:
        return hitting_poses(objects[tool].moved(at), objects[thing].moved(there), above_m=0.0)

    def wipings(tool: str, at: Pose, thing: str, there: Pose) -> Iterator[tuple[Pose, Pose]]:
        for way in wiping_ways(objects[tool].moved(at), objects[thing].moved(there), above_m=0.0):
            yield way[0], way[farthest(way)]

    def hangings(thing: str, at: Pose, rack: str, there: Pose) -> Iterator[Pose]:
        return hung_poses(objects[thing].moved(at), objects[rack].moved(there), [])

    def insertions(thing: str, at: Pose, place: str, there: Pose) -> Iterator[tuple[float, Pose]]:
        return inserted_poses(objects[thing].moved(at), objects[place].moved(there))

    hands = HandCameras(load_robot(scene.robot), objects, goals)
    return CriticQuestion(
        text=asking.text,
        goals=list(goals),
        **{when: _views(when, seen, taken_by) for when in ("before", "after", "moment", "later", "start")},
        uncalibrated={when: {k: p for k, p in by.items() if k not in taken_by} for when, by in seen.items()},
        references={o.id: context.look(o, opened.get(o.id, ())) for o in scene.objects},
        stood_up=_stood_up(objects.values(), context),
        planned={o.id: o.pose.pose() for o in scene.objects},
        opened=opened,
        parts={o.id: [link.name for link in o.asset.model.links] for o in objects.values()},
        rooms=_rooms(goals, objects, opened),
        looks=_part_looks(goals, scene, context, opened),
        draw=draw,
        readings=readings,
        readers=_with_face("reader", objects),
        strikes=strikes,
        hitters=_with_face("head", objects),
        wipings=wipings,
        wipers=_with_face("pad", objects),
        hangings=hangings,
        insertions=insertions,
        presses=hands.presses,
        grasps=hands.grasps,
        fingers=hands.fingers,
        contents=_contents(scene),
        table_height=scene.table.height,
        tops=_tops(objects.values(), scene.table.height),
        towards_customer=tuple(TOWARDS_CUSTOMER.tolist()),
        background=asking.background,
        grasped=asking.grasped,
        statements=list(asking.statements),
    )


def _stood_up(things: Iterable[SceneObject], context: StageContext) -> dict[str, StoodUp]:
    """How the objects that lie on their sides look when they stand, by id."""
    lying = [one for one in things if one.asset.standing is not None]
    standing = [one.record.model_copy(update={"variant": one.asset.variant.laid}) for one in lying]
    looks = map(context.look, standing)
    return {one.id: StoodUp(look, one.asset.stands.inverse()) for one, look in zip(lying, looks, strict=True)}


def _with_face(kind: str, objects: Mapping[str, SceneObject]) -> list[str]:
    """Ids of the objects with a face of a kind."""
    return [name for name, one in objects.items() if one.asset.annotation.faces_of(kind)]


def _contents(scene: Scene) -> dict[str, list[str]]:
    """Ids of the balls in a heap at the start, by what they lie in."""
    found: dict[str, list[str]] = {}
    for o in scene.objects:
        if o.heaped:
            found.setdefault(str(o.container), []).append(o.id)
    return found


def _views(when: str, seen: Seen, taken_by: Mapping[str, Camera]) -> dict[str, View]:
    """The pictures of a moment from the calibrated cameras, by camera."""
    shown = {name: p for name, p in seen.get(when, {}).items() if name in taken_by}
    return {name: _view(p, taken_by[name], f"{when}, {name}") for name, p in shown.items()}


def _view(picture: np.ndarray, camera: Camera, name: str) -> View:
    """A picture with the camera that took it.

    Raises:
        InputFileError: it is of another size than that camera takes, or has other channels.
    """
    if picture.shape != (camera.height, camera.width, 3):
        raise InputFileError(
            f"the picture ({name}) has the shape {picture.shape}; its camera takes {camera.width} x {camera.height}",
            hint="give pictures as collect keeps them in episodes/critic",
        )
    return View(picture, camera)


def _part_looks(
    goals: Sequence[Goal], scene: Scene, context: StageContext, opened: Mapping[str, Sequence[str]]
) -> dict[str, Reference]:
    """Reference views of each object with a part named by a goal, in its earlier state, by id."""
    found = {}
    for goal in goals:
        if goal.kind.acts_on is not None and goal.part is not None:
            own = [goal.part] if goal.kind.rests else []
            found[goal.subject] = context.look(scene.object(goal.subject), [*opened.get(goal.subject, ()), *own])
    return found


def _rooms(
    goals: Sequence[Goal], objects: Mapping[str, SceneObject], opened: Mapping[str, Sequence[str]]
) -> dict[Goal, np.ndarray]:
    """Corners of the space that each goal's object may take in or on another: see :func:`_room`."""
    held = [goal for goal in goals if goal.relation in HOLDING and goal.reference in objects]
    return {goal: _room(goal, objects, opened) for goal in held}


def _room(goal: Goal, objects: Mapping[str, SceneObject], opened: Mapping[str, Sequence[str]]) -> np.ndarray:
    """(n, 8, 3) corners of the target of an object in or on another, in the frame of that: from each floor up to its
    rim, or as high as the object stands on it."""
    thing, holder = objects[goal.subject].as_standing, objects[str(goal.reference)]
    place = holder.asset
    far = {link.name: link.joint.far_end for link in place.model.links}
    joints = [far[link.name] * (link.name in opened.get(str(goal.reference), ())) for link in place.model.links]
    frames, found = link_poses(place.model, joints), []
    for point in place.annotation.functional_points:
        if point.is_of(goal.part) and (point.holds == "in") == (goal.relation == "inside"):
            opening, nested = place.opening(point), nested_bottom(thing, holder, point)
            floor = opening.floor if nested is None else nested
            middle = np.array(opening.centre)
            half = np.array(opening.size if nested is None else thing.asset.footprint) / 2
            top = max(opening.rim, floor + float(thing.asset.size[2]))
            lower, upper = [*(middle - half), floor], [*(middle + half), top]
            found.append(frames[point.link].apply(box_corners(lower, upper)))
    return np.reshape(found, (-1, 8, 3))


def _tops(objects: Iterable[SceneObject], table_height: float) -> list[float]:
    """Heights in the world at which things can stand on objects of a table, the low ones first, metres; each to a
    centimetre over the table."""
    points = [point for o in objects for point in o.asset.annotation.functional_points if point.link is None]
    tops = [point.position[2] for point in points if point.holds == "on"]
    return [table_height + top for top in sorted({round(top, 2) for top in tops if top > SETTINGS.low_m})]


def _opened(goals: Sequence[Goal], requires: Sequence[Goal], statements: Sequence[Statement]) -> dict[str, list[str]]:
    """The parts open before and after, by the plan: by their object."""
    stays = [statement.goal for statement in statements if statement.goal is not None]
    found: dict[str, list[str]] = {}
    for goal in (*requires, *stays, *(g for g in goals if g.relation == "inside" and g.part)):
        owner = goal.subject if goal.relation == "open" else goal.reference
        if goal.relation in ("open", "inside") and goal.part and owner:
            found.setdefault(owner, []).append(goal.part)
    return found
