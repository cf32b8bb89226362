"""A task that is to be said in other words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from vcage.base.text import one_line
from vcage.models.quantifiers import quantified
from vcage.models.wording_review import Review
from vcage.objects.mentions import full_names
from vcage.objects.scene_names import SceneNames
from vcage.plans.actions import HOLDING
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Description, Goal, named_by

MAX_CHARACTERS = 300
"""Characters of a sentence at most."""


class TaskWordings(NamedTuple):
    """Sentences that say a task.

    Args:
        sentences: that hold against the review.
        dropped: how many others were proposed that do not.
    """

    sentences: list[str]
    dropped: int = 0


@dataclass(frozen=True)
class TaskToWord:
    """The requests a sentence must state for a task, and the names it may use.

    Args:
        instruction: in plain language.
        goals: the requests of the instruction, by step.
        untouched: ids of objects to leave alone.
        descriptions: its statements about places at the start.
        things: by object id the catalogue's entries, each with the object's own look only.
        phrases: the scene's name of each object.
        lying: object id → id of its container or support.
        tools: ids of the tools of the task.
        catalogue: all kinds: their names must not be used for missing objects.
    """

    instruction: str
    goals: Sequence[AskedGoal]
    untouched: Sequence[str]
    descriptions: Sequence[Description]
    things: Mapping[str, CatalogueEntry]
    phrases: Mapping[str, str]
    lying: Mapping[str, str]
    tools: Sequence[str]
    catalogue: Sequence[CatalogueEntry]

    @cached_property
    def names(self) -> SceneNames:
        """Names of the objects."""
        return SceneNames(self.things, self.phrases, self.descriptions, self.lying)

    @cached_property
    def strangers(self) -> frozenset[tuple[str, ...]]:
        """Names of kinds that no object has."""
        here = {entry.name for entry in self.things.values()}
        absent = full_names(entry for entry in self.catalogue if entry.name not in here)
        return absent - full_names(self.things.values())

    @cached_property
    def quantified(self) -> frozenset[str]:
        """Ids of the objects that fall under a quantifier of the instruction."""
        return self.ranges_over(self.instruction)

    def ranges_over(self, sentence: str) -> frozenset[str]:
        """Ids of the objects that fall under the quantifiers of a sentence."""
        ranging = quantified(sentence)
        return frozenset(name for name, kind in self.things.items() if any(q.covers(kind) for q in ranging))

    @cached_property
    def spoken(self) -> frozenset[str]:
        """Ids of the objects that a sentence may name."""
        stated = [*(asked.goal for asked in self.goals), *self.descriptions]
        named = {*named_by(stated), *self.tools, *self.untouched}
        return frozenset(name for name in self.things if name in named)

    @cached_property
    def sources(self) -> Mapping[Goal, Description]:
        """The descriptions of the sources of objects, each by the first goal of its object."""
        lying = {d.subject: d for d in self.descriptions if d.relation in HOLDING and d.reference in self.things}
        first: dict[str, Goal] = {}
        for asked in sorted(self.goals, key=lambda a: a.step):
            if asked.goal.kind.acts_on is None:
                first.setdefault(asked.goal.subject, asked.goal)
        return {goal: lying[name] for name, goal in first.items() if name in lying}

    def reviewed(self, sentences: Sequence[str]) -> list[str]:
        """The sentences that have no complaint, each once."""
        return [text for text in dict.fromkeys(sentences) if not self.complaints(text)]

    def complaints(self, sentence: str) -> list[str]:
        """Complaints that the sentence is untrue of the scene, ambiguous in it, or not an exact request."""
        if not 0 < len(sentence) <= MAX_CHARACTERS or one_line(sentence) != sentence or not sentence.isprintable():
            return [f"a sentence has 1 to {MAX_CHARACTERS} characters, on one line"]
        return [*Review(self, sentence).complaints()]
