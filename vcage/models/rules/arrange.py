"""Solves a layout plan's relations on the table plane: where each object goes, and how far it turns.

Objects are placed one after another on a grid. What turns out badly is placed earlier in the next round
(squeaky-wheel optimisation: Joslin and Clements, 1999), then single objects and pairs are moved while that helps.
"""

from __future__ import annotations

import itertools
import logging
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from vcage.base.geometry import wrap_angle
from vcage.models.rules.footprints import Footprint
from vcage.models.rules.groups import Group, Placement, group_of, overlapping_objects, supports_of
from vcage.models.rules.misfit import GAP, misfit
from vcage.models.rules.room_to_stand import Grid, PlacedGroup, overlapping
from vcage.plans.check import Capacity
from vcage.plans.relations import hold
from vcage.schema.plan import TABLE, LayoutPlan, Plan, Relation
from vcage.schema.scene import Scene

logger = logging.getLogger(__name__)

TIERS = ((GAP, True), (GAP, False), (GAP / 2, False), (0.005, False))
"""(gap, whether objects must also not hide each other in the picture): given up one after another."""

ROUNDS = 8
"""Orders of placing that are tried while relations are broken."""

PAIR_TRIES = 12
"""Places of one object that are tried while another's is sought."""

MOVES = 100
"""Moves that are tried in all to mend what is broken after the rounds."""

_OVERLAP = 1000.0
"""What an overlap costs, in broken relations."""


def arrange(
    scene: Scene,
    plan: LayoutPlan | Plan,
    items: Sequence[Footprint],
    fixed: Mapping[str, Placement] | None = None,
    rooms: Mapping[str, Capacity] | None = None,
) -> dict[str, Placement]:
    """A placement for every object: relations first, no overlap, in the workspace, then short distances.

    Where relations and free space cannot both be had, relations give way, so no object is ever lost. Where there is no
    free space left, objects overlap as little as they can, and a warning names them. What lies in or
    on another object at the start and by the plan moves with it; what is only planned there is centred in its opening.
    An object that the picture does not show stays where it is. Relations that name what there is not are passed over.

    Args:
        fixed: objects whose place is known already.
        rooms: geometry of the objects, as far as it is known; tells where openings are.
    """
    known = {item.record.id: item for item in items}
    relations = [r for r in plan.relations if r.subject in known and r.reference in (*known, TABLE)]
    found = _Search(scene, relations, known, dict(fixed or {}), rooms or {}).run()
    overlapping = overlapping_objects(items, found, relations)
    if overlapping:
        logger.warning("there is no room to keep these apart: %s", ", ".join(overlapping))
    return found


@dataclass
class _State:
    """Groups that have a place, by the root's id."""

    placed: dict[str, PlacedGroup] = field(default_factory=dict)

    @cached_property
    def others(self) -> list[PlacedGroup]:
        return list(self.placed.values())

    @cached_property
    def boxes(self) -> dict[str, np.ndarray]:
        """(2, 3) world boxes of all members."""
        return {name: box for there in self.placed.values() for name, box in there.boxes.items()}

    def without(self, *roots: str) -> _State:
        return _State({root: there for root, there in self.placed.items() if root not in roots})

    def plus(self, there: PlacedGroup) -> _State:
        return _State({**self.placed, there.group.root.record.id: there})


class _Search:
    """The arrangement of one scene; all of it is deterministic."""

    def __init__(
        self,
        scene: Scene,
        relations: list[Relation],
        known: Mapping[str, Footprint],
        fixed: dict[str, Placement],
        rooms: Mapping[str, Capacity],
    ):
        self._scene = scene
        self._relations = relations
        self._grid = Grid(scene)
        self._supports = {s: r for s, r in supports_of(relations, known).items() if s not in fixed}
        carried: dict[str, list[Footprint]] = {}
        for subject, reference in self._supports.items():
            carried.setdefault(reference, []).append(known[subject])
        roots = [item for name, item in known.items() if name not in self._supports]
        for item in roots:
            if item.hidden and item.record.id not in fixed:
                fixed[item.record.id] = Placement(item.centre, 0.0)
        self._fixed = _State()
        self._choices: dict[str, list[Group]] = {}
        for item in roots:
            there = fixed.get(item.record.id)
            turns = [there.turn] if there else list(dict.fromkeys((_turn(item), 0.0)))
            groups = [group_of(item, turn, carried, rooms, relations) for turn in turns]
            if there:
                self._fixed = self._fixed.plus(self._grid.place(groups[0], np.array(there.centre, dtype=np.float64)))
            else:
                self._choices[item.record.id] = groups
        self._root_of = {m.item.record.id: root for root, groups in self._choices.items() for m in groups[0].members}
        for root, standing in self._fixed.placed.items():
            self._root_of.update(dict.fromkeys(standing.boxes, root))
        self._about: dict[str, list[Relation]] = {}
        for r in self._relations:
            for root in {self._root_of[r.subject], self._root_of.get(r.reference)} - {None}:
                self._about.setdefault(root, []).append(r)

    def run(self) -> dict[str, Placement]:
        """Rounds of placing, then mending; the best that was seen."""
        order = self._order()
        best, least = self._fixed, np.inf
        for _ in range(ROUNDS):
            state = self._place_all(order)
            cost, culprits = self._faults(state)
            if cost < least:
                best, least = state, cost
            if not culprits:
                break
            order = sorted(order, key=lambda root: root not in culprits)
        best = self._mend(best)
        found: dict[str, Placement] = {}
        for there in best.others:
            found.update(there.group.placements(there.centre))
        return found

    def _order(self) -> list[str]:
        """References before subjects, among those that are free the plan's order, and unplanned objects last."""
        needs = {root: set() for root in self._choices}
        first: dict[str, None] = {}
        for r in self._relations:
            subject, reference = self._root_of[r.subject], self._root_of.get(r.reference)
            first.setdefault(subject)
            if subject in needs and reference in needs and subject != reference:
                needs[subject].add(reference)
        waiting = [root for root in first if root in needs] + [root for root in needs if root not in first]
        done: list[str] = []
        while waiting:
            ready = next((root for root in waiting if needs[root] <= set(done)), waiting[0])
            waiting.remove(ready)
            done.append(ready)
        return done

    def _place_all(self, order: Sequence[str]) -> _State:
        state = self._fixed
        for root in order:
            state = self._place(root, state)[1]
        return state

    def _place(self, root: str, state: _State) -> tuple[float, _State]:
        """(cost, state with the group at its best place): broken relations first, then tiers, then distances."""
        best: tuple[float, float, Group, np.ndarray] | None = None
        for group in self._choices[root]:
            found = self._best_place(group, state)
            if best is None or found[0] < best[0]:
                best = (*found[:2], group, found[2])
            if best[0] == 0:
                break
        return best[0], state.plus(self._grid.place(best[2], best[3]))

    def _best_place(self, group: Group, state: _State) -> tuple[float, float, np.ndarray]:
        """(broken relations, or more for an overlap; tier's price; centre)."""
        centres = self._grid.centres(group)
        points = centres.points()
        clearance = self._grid.clearance(group, centres, state.others)
        room = np.flatnonzero(clearance >= TIERS[-1][0] - 1e-9)
        if len(room) == 0:
            broken, soft = self._judge(group, points, state)
            depth = self._grid.overlap(group, centres, state.others)
            at = int(np.argmin(1e3 * depth + soft))
            return _OVERLAP + float(broken[at]), len(TIERS), points[at]
        clearance, points = clearance[room], points[room]
        plain = self._grid.plain(group, centres, state.others)[room]
        broken, soft = self._judge(group, points, state)
        best: tuple[float, float, np.ndarray] | None = None
        for price, (gap, seen) in enumerate(TIERS):
            free = (clearance >= gap - 1e-9) & (plain | (not seen))
            if not free.any():
                continue
            score = np.where(free, 1e3 * broken + soft, np.inf)
            at = int(np.argmin(score))
            if best is None or broken[at] < best[0]:
                best = (float(broken[at]), price, points[at])
            if best[0] == 0:
                break
        return best

    def _judge(self, group: Group, points: np.ndarray, state: _State) -> tuple[np.ndarray, np.ndarray]:
        """(n,) relations to what is placed that break with the group at each point, and how well it stands there."""
        soft = 0.05 * np.linalg.norm(points - group.root.centre, axis=1)
        broken = np.zeros(len(points))
        members = {m.item.record.id: m for m in group.members}
        boxes: dict[str, np.ndarray] = {}
        for r in self._about.get(group.root.record.id, ()):
            if (r.subject in members) == (r.reference in members):
                continue
            own, other = (r.subject, r.reference) if r.subject in members else (r.reference, r.subject)
            there = self._grid.table if other == TABLE else state.boxes.get(other)
            if there is None:
                continue
            if own not in boxes:
                boxes[own] = members[own].boxes(points)
            pair = (boxes[own], there) if r.subject in members else (there, boxes[own])
            broken += ~hold(r.relation, *pair)
            soft += misfit(r, *pair, self._scene)
        return broken, soft

    def _broken(self, state: _State) -> list[Relation]:
        boxes = {**state.boxes, TABLE: self._grid.table}
        return [r for r in self._relations if not hold(r.relation, boxes[r.subject], boxes[r.reference])]

    def _faults(self, state: _State) -> tuple[float, list[str]]:
        """(overlaps and broken relations, the groups that can be moved to mend them)."""
        broken = self._broken(state)
        involved = [self._root_of.get(name) for r in broken for name in (r.subject, r.reference)]
        overlapping = self._overlapping(state)
        culprits = [root for root in dict.fromkeys((*overlapping, *involved)) if root in self._choices]
        return _OVERLAP * len(overlapping) + len(broken), culprits

    def _overlapping(self, state: _State) -> list[str]:
        """Groups that can be moved and overlap another."""
        found = (there.group.root.record.id for there in overlapping(state.others))
        return [root for root in found if root in self._choices]

    def _mend(self, state: _State) -> _State:
        """Move single groups, then pairs of a broken relation, as long as the faults become fewer."""
        cost, culprits = self._faults(state)
        left = MOVES
        while culprits:
            moves = enumerate(itertools.islice(self._moves(state, culprits), left), 1)
            tried, better = next(((n, s) for n, s in moves if self._faults(s)[0] < cost), (0, None))
            if better is None:
                return state
            left, state = left - tried, better
            cost, culprits = self._faults(state)
        return state

    def _moves(self, state: _State, culprits: Sequence[str]) -> Iterable[_State]:
        for root in culprits:
            yield self._place(root, state.without(root))[1]
        pairs = [tuple(self._root_of.get(n) for n in (r.subject, r.reference)) for r in self._broken(state)]
        for first, second in dict.fromkeys(itertools.chain(pairs, (pair[::-1] for pair in pairs))):
            if first in self._choices and second in self._choices and first != second:
                rest = state.without(first, second)
                for group in self._choices[first]:
                    for centre in self._spread(group, rest):
                        yield self._place(second, rest.plus(self._grid.place(group, centre)))[1]

    def _spread(self, group: Group, state: _State) -> np.ndarray:
        """(k, 2) free places of a group, those that break the fewest relations, spread over all of these."""
        centres = self._grid.centres(group)
        free = self._grid.clearance(group, centres, state.others) >= TIERS[-1][0]
        points = centres.points()[free]
        if len(points) == 0:
            return points
        broken, soft = self._judge(group, points, state)
        good = np.flatnonzero(broken == broken.min())
        good = good[np.argsort(soft[good], kind="stable")]
        return points[good[np.unique(np.linspace(0, len(good) - 1, PAIR_TRIES).astype(int))]]


def _turn(item: Footprint) -> float:
    """Long contents are laid pointing away from the robot; receptacles face it; the rest stays as it is."""
    if item.record.role == "receptacle":
        return float(wrap_angle(-item.record.pose.pose().yaw))
    if item.elongated:
        return float((np.pi / 2 - item.axis + np.pi / 2) % np.pi - np.pi / 2)
    return 0.0
