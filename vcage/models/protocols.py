"""Interfaces of the models' roles; offline stand-ins and online clients implement the same.

Pictures are (H, W, 3) uint8 RGB. Every implementation has a ``provider`` name, which is written into each
file affected by its answers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.checked_reading import Instructed
from vcage.models.wordings import TaskToWord, TaskWordings
from vcage.plans.check import PlanCheck
from vcage.schema.asset import CatalogueEntry
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal, Reading
from vcage.schema.plan import LayoutPlan, Relation, Selection, SelectionCheck
from vcage.schema.scene import PLAIN, Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, SlotAnswer, SlotQuestion, Statement
from vcage.vision.protocols import Detector, Embedder, Reference, View

if TYPE_CHECKING:
    from vcage.layout.intended import IntendedLayout
    from vcage.layout.items import TableItem
    from vcage.sim.drawer import Drawing, Window


OFFLINE = "offline"
"""The provider of what answers without a model."""


@dataclass(frozen=True)
class EditRequest:
    """Rearrange the objects of ``picture`` as ``plan`` says.

    Args:
        picture: the top view I_src.
        background: the same view of the empty table.
        segmentation: (H, W) int, values of ``scene.segmentation_ids``, 0 where no object is.
        items: geometry of the objects by id, as far as it is known; of the others their records tell it.
    """

    picture: np.ndarray
    background: np.ndarray
    segmentation: np.ndarray
    scene: Scene
    plan: LayoutPlan
    items: Mapping[str, TableItem] = field(default_factory=dict)

    @cached_property
    def hidden(self) -> list[str]:
        """Ids of the objects that the picture does not show; they stay in place."""
        shown = set(np.unique(self.segmentation).tolist())
        ids = self.scene.segmentation_ids
        return [o.id for o in self.scene.objects if not o.heaped and ids.get(o.id, -1) not in shown]

    @cached_property
    def layout(self) -> IntendedLayout:
        """Poses of the objects by the plan, for any editor."""
        return self.laid_out(self.plan.relations)

    def laid_out(self, relations: Sequence[Relation]) -> IntendedLayout:
        """Poses of the objects by those relations alone."""
        # Imported late: `vcage doctor` lists the keys even on a machine without the solver's packages.
        from vcage.layout.intended import intended_layout
        from vcage.layout.items import item_of

        items = {o.id: self.items.get(o.id) or item_of(o) for o in self.scene.objects}
        fixed = {name: self.scene.object(name).pose.pose() for name in self.hidden}
        return intended_layout(self.scene, relations, items, fixed)


DrawObject: TypeAlias = "Callable[[str, Pose, Camera, Window, Mapping[str, float]], Drawing]"
"""An object, by id, alone at a pose, as a camera sees it through a window, with its parts at shares of their ranges."""

THIN_SUPPORT_M = 0.025
"""A support that is lower, metres, shows no side: no camera looks at it, and critics take it to be under what hides
it."""


@dataclass(frozen=True)
class StoodUp:
    """How an object that lies on its side at the start looks when it stands.

    Args:
        look: from above then.
        lying: its frame, which is that of the lying body, in the frame in which it stands.
    """

    look: Reference
    lying: Pose


@dataclass(frozen=True)
class HandView:
    """A camera on a hand while the hand presses or holds something.

    Args:
        camera: where it is then.
        fingers: (2 * 8, 3) corners of the two fingers, one after the other, in the world, metres.
        gripper: gripper frame in the world.
    """

    camera: Camera
    fingers: np.ndarray
    gripper: Pose


@dataclass(frozen=True)
class CriticQuestion:
    """Was the sub-task done? Pictures and calibration only, never simulator state.

    Args:
        text: the sub-task in words.
        goals: the same in the closed vocabulary.
        before, after: view by camera name; always with ``top``, with the robot at its home in both.
        references: object id → its reference picture, for every object of the scene.
        stood_up: the objects that lie on their sides at the start, as they look when they stand, by id.
        looks: for goals about a moving part: object id → its planned appearance before.
        draw: draws the scene's objects.
        readings: poses of one object, by id, at which it reads or is read by another: their ids, each with the pose
            that says how it stands.
        readers: ids of the objects that read bar codes.
        strikes: poses of a tool at which its head is on an object: their ids, each with the pose that says how it
            stands.
        hitters: ids of the tools that have a head.
        wipings: poses of a tool on an object, each where wiping begins and where a stroke ends farthest from there:
            their ids, each with the pose that says how it stands.
        wipers: ids of the tools that have a pad.
        hangings: poses of a thing that hangs on a rack: their ids, each with the pose that says how it stands.
        insertions: poses of a thing in line with a hole of another, each with the share of the hole's length that it
            fills: their ids, each with the pose that says how it stands.
        presses: views of a camera on a hand that presses a part of an object, one for each way in which the hand may
            come: the object's id, how it stands, part and name of the camera; none of a camera that no hand carries.
        grasps: the same of a hand that holds an object, one for each way in which its fingers may close on it: the
            object's id, how it stands and name of the camera.
        fingers: drawings of the fingers of the hand that carries a camera, as that camera sees them, from closed to
            wide open, by the camera's name; none where no hand carries it.
        contents: ids of the balls that lie loose in a vessel at the start, by the vessel's.
        grasped: id of the object to grasp, if it is not the object of the goals.
        moment: view by camera name while a part was touched, a code was before a scanner, a tool was on what it hits or
            where it begins to wipe, a vessel was tipped, one hand or two held a thing up, a shaken thing leaned first,
            or a thing came to lie on a scale.
        later: view by camera name where a stroke of wiping ends, far from where it began, or at the last lean of a
            shake.
        start: view by camera name at the start of the episode; only where something is put back.
        uncalibrated: pictures by camera name, by time, of moving cameras: of both hands before and after; of the acting
            hand at the moment and later, or at the release; and, at the moment of a scan, of bar code and window.
        planned: the layout's place of each object, without later changes.
        opened: parts planned to be open before and after, by their object.
        parts: names of the moving parts, by the object that has them.
        rooms: for goals with one object in or on another: (n, 8, 3) corners of its target, in the other's frame.
        table_height: z of the table top, metres (part of the calibration).
        tops: z of supports besides the table, by the objects of the scene, metres.
        towards_customer: (3,) unit vector from the middle of the table to the customer.
        background: the ``top`` view of the empty table in the same light, where there is one.
        statements: other facts to preserve.
    """

    text: str
    goals: Sequence[Goal]
    before: dict[str, View]
    after: dict[str, View]
    references: dict[str, Reference] = field(default_factory=dict)
    stood_up: Mapping[str, StoodUp] = field(default_factory=dict)
    looks: dict[str, Reference] = field(default_factory=dict)
    draw: DrawObject | None = None
    readings: Callable[[str, Pose, str, Pose], Iterable[Pose]] | None = None
    readers: Sequence[str] = ()
    strikes: Callable[[str, Pose, str, Pose], Iterable[Pose]] | None = None
    hitters: Sequence[str] = ()
    wipings: Callable[[str, Pose, str, Pose], Iterable[tuple[Pose, Pose]]] | None = None
    wipers: Sequence[str] = ()
    hangings: Callable[[str, Pose, str, Pose], Iterable[Pose]] | None = None
    insertions: Callable[[str, Pose, str, Pose], Iterable[tuple[float, Pose]]] | None = None
    presses: Callable[[str, Pose, str, str], Iterable[HandView]] | None = None
    grasps: Callable[[str, Pose, str], Iterable[HandView]] | None = None
    fingers: Callable[[str], Sequence[Drawing]] | None = None
    contents: Mapping[str, Sequence[str]] = field(default_factory=dict)
    grasped: str | None = None
    moment: dict[str, View] = field(default_factory=dict)
    later: dict[str, View] = field(default_factory=dict)
    start: dict[str, View] = field(default_factory=dict)
    uncalibrated: dict[str, dict[str, np.ndarray]] = field(default_factory=dict)
    planned: Mapping[str, Pose] = field(default_factory=dict)
    opened: Mapping[str, Sequence[str]] = field(default_factory=dict)
    parts: Mapping[str, Sequence[str]] = field(default_factory=dict)
    rooms: Mapping[Goal, np.ndarray] = field(default_factory=dict)
    table_height: float = 0.74
    tops: Sequence[float] = ()
    towards_customer: tuple[float, float, float] = (0.0, 1.0, 0.0)
    background: np.ndarray | None = None
    statements: Sequence[Statement] = ()


class Reasoner(Protocol):
    """Chooses, plans and filters; its selections and plans pass the caller's check, or it refuses."""

    provider: str

    def select_assets(
        self,
        instruction: str,
        catalogue: Sequence[CatalogueEntry],
        rng: np.random.Generator,
        check: SelectionCheck,
        scene: str = PLAIN,
    ) -> Selection:
        """The objects for the instruction, and some that suit the occasion.

        Args:
            scene: name of the scene template; kinds that list it among their scenes are preferred.
            check: its complaints are answered, within the reasoner's rounds.

        Raises:
            NoAssetFits: the catalogue has nothing that the instruction names.
            ModelRefused: the last round's selection is still complained about; lists the complaints.
        """
        ...

    def plan_layout(
        self, scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: PlanCheck
    ) -> LayoutPlan:
        """A layout of the scene's objects for the instruction.

        Args:
            check: its complaints are answered, within the reasoner's rounds.

        Raises:
            ModelRefused: the last round's plan is still complained about; lists the complaints.
        """
        ...

    def judge_pairs(self, questions: Sequence[PairQuestion], instruction: str | None = None) -> list[PairAnswer]:
        """Check if each object can sensibly be put in or on each receptacle; one answer per question, in order.

        Args:
            questions: in any number.
            instruction: the request to the robot in the scene, if there is one.
        """
        ...

    def fill_slots(self, instruction: str | None, questions: Sequence[SlotQuestion]) -> list[SlotAnswer]:
        """Choices for the sub-tasks of a chain among feasible options, and states to preserve; one answer each.

        Choices left open follow the ranking.

        Args:
            instruction: the instruction of the chain; None where each sub-task is a task of its own.
            questions: in the order of the chain.

        Raises:
            ModelRefused: the last round's answer is still complained about; lists the complaints.
        """
        ...

    def read_goals(self, asked: Instructed) -> Reading:
        """Goals of the instruction in a scene, each with the words that it answers.

        Raises:
            UnreadInstruction: some words match no goal, or are ambiguous; names them. Where other
                objects are needed, ``details["wrong_objects"]`` says why.
            ModelRefused: the last round's answer is still complained about; lists the complaints.
        """
        ...

    def word_task(self, task: TaskToWord, plain: Sequence[str]) -> TaskWordings:
        """Further sentences that say a task; each holds against :meth:`TaskToWord.complaints`.

        Args:
            task: the goals they must ask for, and the names they may use.
            plain: sentences from templates; none where a clear name is missing.
        """
        ...


class ImageEditor(Protocol):
    """Draws the planned layout."""

    provider: str

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The target picture I_tgt (H', W', 3); online editors may answer in another size."""
        ...


class Critic(Protocol):
    """The paper's φ_VLM(I, T)."""

    provider: str

    def judge(self, question: CriticQuestion) -> Verdict:
        """Judge from the pictures if the sub-task was done; the caller fills in ``Verdict.pictures``."""
        ...


@dataclass(frozen=True)
class Models:
    """One implementation for each role."""

    reasoner: Reasoner
    editor: ImageEditor
    detector: Detector
    embedder: Embedder
    critic: Critic

    def providers(self, *roles: str) -> dict[str, str]:
        """Provider by role, for a record's provenance."""
        return {role: getattr(self, role).provider for role in roles}
