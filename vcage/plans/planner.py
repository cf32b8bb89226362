"""Finds the shortest chain of sub-tasks that achieves goals in their order, and checks any chain for it.

Every goal is achieved by a step of the chain, and in its turn: a goal true at the start was not
done, and a premature one was not done in order. Nothing is done beyond requests and their preconditions:
what had to be opened is closed again where a goal or a later step needs it closed, else it stays open.
What an earlier step put in or on a thing is there when that is lifted, held up or moved away.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from vcage.plans.actions import HOLDING, Action, State, lasting
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE

MOST_STATES = 200_000
"""The search ends after so many states."""


@dataclass(frozen=True)
class Task:
    """A planning problem.

    Args:
        initial: goals true at the start; including open or closed for every moving part.
        steps: goals in their order; goals of one step in any.
    """

    initial: State
    steps: tuple[frozenset[Goal], ...]

    @property
    def final(self) -> frozenset[Goal]:
        """The goals that must be true at the end."""
        return frozenset(lasting(self.steps))

    def put_by(self, step: int, places: Collection[str]) -> frozenset[Goal]:
        """The goals of the steps before one that leave something in or on some objects for good."""
        earlier = frozenset().union(*self.steps[:step])
        return frozenset(g for g in self.final & earlier if g.relation in HOLDING and g.reference in places)


@dataclass(frozen=True)
class _Node:
    """A search node: the state, the present step, and its goals already achieved."""

    state: State
    step: int
    done: frozenset[Goal]

    def after(self, action: Action, task: Task) -> _Node | None:
        """The node after an action; None where it brings about a goal before its turn, or without what should lie in or
        on its object: "put the apple in the basket, then lift the basket" lifts no empty basket."""
        now = task.steps[self.step] if self.step < len(task.steps) else frozenset()
        early = frozenset().union(*task.steps[self.step + 1 :]) - now
        new = action.adds - self.state
        if new & early:
            return None
        state = action.after(self.state)
        if not task.put_by(self.step, {g.subject for g in action.adds & now if g.reference is None}) <= state:
            return None
        done = self.done | (action.adds & now)
        if now and done == now and all(g in state for g in lasting([now])):
            return _Node(state, self.step + 1, frozenset())
        return _Node(state, self.step, done)

    def is_end(self, task: Task) -> bool:
        return self.step == len(task.steps) and task.final <= self.state


def find_chain(task: Task, actions: Iterable[Action]) -> list[str] | None:
    """Names of the actions of a shortest chain; None where there is none within :data:`MOST_STATES`."""
    useful = _useful(task, list(actions))
    start = _Node(task.initial, 0, frozenset())
    came: dict[_Node, tuple[_Node, str] | None] = {start: None}
    queue = deque([start])
    while queue and len(came) < MOST_STATES:
        node = queue.popleft()
        if node.is_end(task):
            return _names(came, node)
        for action in useful:
            if action.obstacle(node.state):
                continue
            following = node.after(action, task)
            if following is not None and following not in came:
                came[following] = (node, action.name)
                queue.append(following)
    return None


def _names(came: Mapping[_Node, tuple[_Node, str] | None], node: _Node) -> list[str]:
    names: list[str] = []
    before = came[node]
    while before is not None:
        node, name = before
        names.append(name)
        before = came[node]
    return names[::-1]


def _useful(task: Task, actions: Sequence[Action]) -> list[Action]:
    """The actions that a chain may need: those that achieve a goal, or a precondition of such an action, and so on."""
    wanted = set[Goal]().union(*task.steps)
    found: list[Action] = []
    left = list(actions)
    while True:
        laden = _in_the_way(task, found)
        more = [a for a in left if a.adds & wanted or (a.moves in laden and _sets_aside(a))]
        if not more:
            return found
        found += more
        left = [a for a in left if a not in more]
        wanted = wanted.union(*(action.requires for action in more))


def _in_the_way(task: Task, actions: Sequence[Action]) -> set[str]:
    """Objects that may lie in or on something that some actions need bare, or stand at a place that they need."""
    movable = {g.subject for g in task.initial if g.relation in HOLDING}
    bare = {name for a in actions for name in (a.moves, a.empty) if name is not None}
    lying = task.initial.union(*(a.adds for a in actions))
    laden = {g.subject for g in lying if g.relation in HOLDING and g.reference in bare}
    return (laden | {a.vacant for a in actions if a.vacant is not None}) & movable


def _sets_aside(action: Action) -> bool:
    return any(g.reference == TABLE for g in action.adds)


def complaints(task: Task, chain: Sequence[Action]) -> list[str]:
    """Why a chain does not achieve the request, one sentence each; empty when it is proven to."""
    node = _Node(task.initial, 0, frozenset())
    for action in chain:
        obstacle = action.obstacle(node.state)
        if obstacle:
            return [f"{action.name} is not possible then: {obstacle}"]
        following = node.after(action, task)
        if following is None:
            return [f"{action.name} comes before what must be done first"]
        node = following
    left: Collection[Goal] = [g for step in task.steps[node.step :] for g in step if g not in node.done]
    undone = [f"{goal} is not brought about in its turn" for goal in left]
    return undone + [f"{goal} is not true at the end" for goal in sorted(task.final - node.state, key=str)]
