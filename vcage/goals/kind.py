"""A kind of goal: the library's whole knowledge of one word, and the simulator data a goal may use."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Protocol

from vcage.base.geometry import Pose
from vcage.goals.thresholds import Thresholds

TABLE = "table"
"""The reference of a goal or relation to the table itself."""


class Stated(Protocol):
    """A goal as a record holds it (:class:`vcage.schema.goals.Goal`)."""

    @property
    def subject(self) -> str:
        """Id of an object."""

    @property
    def relation(self) -> str:
        """The word of its kind."""

    @property
    def reference(self) -> str | None:
        """Id of another object, ``table``, or an arm."""

    @property
    def part(self) -> str | None:
        """Moving part of the subject, or of the reference."""


class Thing(Protocol):
    """An object where it stands (:class:`vcage.tasks.scene_objects.SceneObject`)."""

    @property
    def id(self) -> str:
        """Its name in the scene."""

    @property
    def pose(self) -> Pose:
        """Object frame in the world."""

    @property
    def aabb(self) -> Any:
        """(2, 3) axis-aligned box in the world, metres."""

    @property
    def lowest(self) -> float:
        """z of its lowest point, metres."""


class Inserted(NamedTuple):
    """How a shaft lies in a hole.

    Args:
        share: of the length of the hole that it fills.
        aside_m: largest distance between their axes in the hole, metres.
        leans_rad: angle between their axes, radians.
    """

    share: float
    aside_m: float
    leans_rad: float


class State(Protocol):
    """The simulator's state, and what happened since the sub-task began (:class:`vcage.tasks.state.Watch`)."""

    @property
    def arms(self) -> Collection[str]:
        """Names of the robot's arms."""

    @property
    def table_height(self) -> float:
        """z of the table top, metres."""

    def thing(self, name: str) -> Thing:
        """An object as it stands now."""

    def at_start(self, name: str) -> Thing:
        """An object as it stood at the start of the episode."""

    def touching(self, name: str) -> set[str]:
        """Ids of objects, names of arms, and ``table``, that press on an object."""

    def holds(self, arm: str, name: str) -> bool:
        """True where all fingers of an arm press on an object."""

    def speed_m_per_s(self, name: str) -> float:
        """Speed of an object since the last look."""

    def at_rest(self, name: str) -> bool:
        """True if an object hardly moves now."""

    def share(self, name: str, part: str) -> float:
        """Position of a moving part, as a share of its range from rest."""

    def furthest_share(self, name: str, part: str) -> float:
        """The same where it was farthest from rest."""

    def lasted_s(self, goal: Stated) -> float:
        """Longest time that the event of a goal went on without a break."""

    def weighs(self, name: str) -> bool:
        """True where a name is that of a scale."""

    def is_read(self, name: str) -> bool:
        """True where the window of a scanner reads a bar code of an object."""

    def is_hit(self, name: str) -> bool:
        """True where the head of a tool in a hand presses on the middle of an object's top."""

    def stands(self, goal: Stated) -> bool:
        """True where the geometry of the goal's relation word holds between the boxes of its two objects."""

    def wiping(self, name: str) -> tuple[Collection[int], int]:
        """Numbers of the cells of an object's flat top that the pad of a tool in a hand wipes now; and of all cells."""

    def contents(self, name: str) -> Collection[str]:
        """Ids of the objects that lay in an object when the sub-task began."""

    def lies_in(self, name: str, other: str) -> bool:
        """True where an object rests in another, and not on its bare top."""

    def hangs_on(self, name: str, rack: str) -> bool:
        """True where a peg of a rack passes through the closed handle of an object."""

    def inserted(self, name: str, place: str) -> Inserted | None:
        """How the shaft of an object lies in a hole of a place; None where one has none."""

    def not_resting(self, goal: Stated) -> str | None:
        """Why the subject does not rest in or on the reference; None where it does."""


@dataclass(frozen=True)
class Shown:
    """Pictures the critic needs besides those from above, before and after.

    Args:
        customer: from the customer's side too: fronts, bar codes and objects in the air are not seen from above.
        moment: those cameras also at the decisive moment.
        later: those also at a second moment, after the first.
        start: also at the start of the episode.
        in_the_air: the camera on the customer's side looks higher.
        close_up: close pictures of bar code and window, at the moment.
    """

    customer: bool = False
    moment: bool = False
    later: bool = False
    start: bool = False
    in_the_air: bool = False
    close_up: bool = False


@dataclass(frozen=True)
class GoalKind:
    """A kind of goal.

    Args:
        word: by which records name it.
        complaint: why a goal does not hold in the simulator's state; None where it does.
        evidence: name of the offline critic's judgement (``EVIDENCE`` of :mod:`vcage.models.rules.evidence`).
        meaning: exact meaning, by its limits, for the prompt of a critic that is a model; line ends are kept,
            indentation is not.
        commands: sentences that ask for it, the plainest first: {0} is the object, {1} the same at the beginning of
            a sentence, {2} the reference, {tool} the tool; ten and more.
        prepositions: instead of commands, for goals about an object's place: words after its verb.
        plain: a goal as a statement; {thing} with its part, {where} the relation to the reference, {reference}.
        says: words, one of which a sentence that asks for it must contain.
        claims: words allowed only in a sentence that asks for it.
        may_say: words that other kinds claim, and that a sentence that asks for it may contain too.
        listed: fields of such a goal, for the prompt of the reader: the same for all kinds of one form.
        gloss: addition of that prompt behind the word.
        refers_to: the kind of its reference; None without one.
        part_of: whose moving part it may name.
        acts_on: parts of its subject: those that ``open``, are ``press``-ed or ``turn``-ed; such a goal needs
            its part and leaves the subject in its place.
        rests: its part is at rest then.
        event: it is about an action, regardless of the state afterwards.
        fleeting: an arm must keep doing it, so that only another one can do anything else.
        opposite: word of the goal that is true where this one is false.
        happens: True while its event goes on; ``notes`` stores earlier observations.
        arms: number of arms that it takes at the same time.
        stays_m: its subject, which no hand takes, is within this of its old place when the sub-task ends; None where
            the limit for all that a sub-task leaves alone holds.
        tool: property of an object without which it cannot be done (:class:`vcage.schema.asset.CatalogueEntry`).
        shown: pictures that the critic needs.
    """

    word: str
    complaint: Callable[[Stated, State], str | None]
    evidence: str
    meaning: Callable[[Thresholds], str]
    says: str
    listed: str = "`subject`."
    commands: str = ""
    prepositions: tuple[str, ...] = ()
    plain: str = "{thing} is {where}"
    claims: str = ""
    may_say: str = ""
    gloss: str = ""
    refers_to: Literal["object", "arm"] | None = None
    part_of: Literal["subject", "reference"] | None = None
    acts_on: Literal["open", "press", "turn"] | None = None
    rests: bool = False
    event: bool = False
    fleeting: bool = False
    opposite: str | None = None
    arms: int = 1
    stays_m: float | None = None
    happens: Callable[[Stated, State, set[str]], bool] | None = None
    tool: Literal["reads_codes", "weighs", "hits", "wipes"] | None = None
    shown: Shown = field(default_factory=Shown)

    @property
    def may_hold_already(self) -> bool:
        """True for a goal about how an object stands, which may be so before anything is done."""
        return self.acts_on is None and self.happens is None and not self.fleeting and not self.shown.start

    @property
    def moves(self) -> bool:
        """True for a goal for which its subject is taken from its place."""
        return self.acts_on is None and self.stays_m is None

    @property
    def form(self) -> str:
        """The form in which a person states such a goal; {} is the word."""
        part = "/PART" if self.acts_on else ""
        place = "[/PART]" if self.part_of == "reference" else ""
        reference = {"object": f" REFERENCE{place}", "arm": " ARM", None: ""}[self.refers_to]
        return f"SUBJECT{part} {{}}{reference}"


def too_short(goal: Stated, state: State, least_s: float) -> str | None:
    """Why an event did not last, or None when it did."""
    lasted = state.lasted_s(goal)
    return None if lasted >= least_s else f"{goal.subject} was {goal.relation} for {lasted:.1f} s only"


# Limits in the words of a prompt.


def cm(metres: float) -> str:
    """A length as in ``2.5 cm``."""
    return f"{100 * metres:g} cm"


def percent(share: float) -> str:
    """A share as in ``80 %``."""
    return f"{100 * share:g} %"


def degrees(angle_rad: float) -> str:
    """An angle as in ``30°``."""
    return f"{angle_rad * 180 / 3.14159265:.0f}°"
