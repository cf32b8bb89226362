"""Propose, verify, give up with reasons: the one loop of every search that draws until a proposal holds.

A proposal is a function that draws, verifies and returns a value, or raises its refusal. All refusals are collected,
so that a search which gives up can say why.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class AttemptLimits:
    """Most attempts at each question before it is given up.

    Args:
        placements: of a scene's objects, until one stays put in the simulator.
        placements_for_hands: of a scene's objects, until a hand has room to take objects out of their containers.
        stowings: ways to lay things into a drawer, until a hand has room around each.
        layouts: near the matched targets, until the instruction can be carried out in one.
        searches: for sub-tasks that achieve the instruction, until a chain does.
        same_searches: searches refused in the same words, after which there are no more.
        episode_layouts: drawn for an episode with all its clutter and variants.
        eased_layouts: drawn for an episode at each share of the clutter.
        compared_starts: random placements for each layout of an episode; the one that breaks the fewest
            relations is optimised: the optimisation moves objects past each other only if it must.
        shifts: small shifts of the run's layout, until all descriptions are true.
        proven_shifts: layouts that are shifted like that, until the chain is proven in one.
        slot_sets: sets of slots for a chain, where another layout would do as well.
        same_slot_sets: sets refused one after the other in the same words, after which no more are tried.
        final_slot_sets: sets of slots for a chain, where there is no other layout.
        compared_slots: arrangements of a receptacle's contents; the one with the lowest drop is taken.
        arrangements: of a receptacle's contents, from which the roomiest are compared first.
        table_slot_sets: sets of places on the table for a chain.
        spare_slots: further slots for an object that cannot be brought to its own.
        table_places: places on the table, until an arm can bring the object to one.
        zone_draws: poses in each zone of the table.
        ground_rounds: times that poses are drawn in all zones of the table, until an arm reaches one.
        unclear_ways: ways to operate a part at which the hand touches it, until no others are looked for.
        ways_past_arms: ways past other arms that are tried for a lifted object: a search in vain takes long.
        home_halvings: times that an arm's start beside home is moved nearer to it while it touches something; at last
            the arm is at home.
    """

    placements: int = 5
    placements_for_hands: int = 40
    stowings: int = 60
    layouts: int = 10
    searches: int = 3
    same_searches: int = 2
    episode_layouts: int = 30
    eased_layouts: int = 10
    compared_starts: int = 30
    shifts: int = 8
    proven_shifts: int = 3
    slot_sets: int = 4
    same_slot_sets: int = 3
    final_slot_sets: int = 20
    compared_slots: int = 8
    arrangements: int = 40
    table_slot_sets: int = 8
    spare_slots: int = 6
    table_places: int = 12
    zone_draws: int = 6
    ground_rounds: int = 3
    unclear_ways: int = 4
    ways_past_arms: int = 4
    home_halvings: int = 4


LIMITS = AttemptLimits()


class Refused(Exception):
    """A proposal that is not accepted.

    Args:
        reason: in words; the same words for the same reason, as refusals are counted by them.
        about: the proposal, for a search that falls back on it.
    """

    def __init__(self, reason: str, about: Any = None):
        super().__init__(reason)
        self.about = about


class GaveUp(Exception):
    """All proposals were refused.

    Args:
        refusals: in the order of the proposals.
    """

    def __init__(self, refusals: Sequence[Exception]):
        super().__init__(f"{len(refusals)} proposals were refused")
        self.refusals = list(refusals)

    @property
    def reasons(self) -> Counter[str]:
        """Number of refusals by reason."""
        return Counter(map(str, self.refusals))


@dataclass(frozen=True)
class Accepted(Generic[T]):
    """The first proposal that held.

    Args:
        value: of the proposal.
        refusals: of those before it, in order.
    """

    value: T
    refusals: list[Exception]

    @property
    def attempts(self) -> int:
        """Number of proposals that were made."""
        return len(self.refusals) + 1

    @property
    def reasons(self) -> dict[str, int]:
        """Number of refusals by reason."""
        return dict(Counter(map(str, self.refusals)))


def first_accepted(
    proposals: Iterable[Callable[[], T]],
    refused_by: type[Exception] | tuple[type[Exception], ...] = Refused,
    same: int | None = None,
) -> Accepted[T]:
    """Return the first proposal that is not refused.

    Args:
        proposals: in order; the same one again (:func:`itertools.repeat`) where it draws at random.
        refused_by: exceptions that refuse a proposal; any other ends the search.
        same: refusals one after the other with the same words, measurements included, that end the search: proposals
            make no difference then.

    Raises:
        GaveUp: all were refused, or so many in the same words, or there were none.
    """
    refusals: list[Exception] = []
    for propose in proposals:
        try:
            return Accepted(propose(), refusals)
        except refused_by as refusal:
            refusals.append(refusal)
        if same is not None and len(refusals) >= same and len({str(one) for one in refusals[-same:]}) == 1:
            break
    raise GaveUp(refusals)


def least_costly(proposals: Iterable[T], cost: Callable[[T], Any], enough: Any = None) -> T:
    """Return the proposal of the lowest cost, the first of equals.

    Args:
        proposals: at least one; drawn one after the other.
        cost: of a proposal.
        enough: the first proposal at or below this cost ends the search; None compares all.
    """
    best: tuple[Any, T] | None = None
    for proposal in proposals:
        found = cost(proposal)
        if best is None or found < best[0]:
            best = found, proposal
        if enough is not None and best[0] <= enough:
            break
    assert best is not None, "nothing was proposed"
    return best[1]
