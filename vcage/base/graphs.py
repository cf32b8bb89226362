"""Directed graphs of names: circles, and the longest path of a graph without any."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter

Edge = tuple[str, str]


def circles(edges: Iterable[Edge]) -> list[list[str]]:
    """Find circles without common nodes, each in the order of its edges, until every other circle touches them."""
    left, found = list(dict.fromkeys(edges)), []
    while True:
        try:
            _sorter(left).prepare()
        except CycleError as error:
            circle = error.args[1][:-1]
            first = circle.index(min(circle))
            found.append([*circle[first:], *circle[:first]])
            left = [edge for edge in left if not set(edge) & set(circle)]
        else:
            return found


def _sorter(edges: Iterable[Edge]) -> TopologicalSorter[str]:
    sorter: TopologicalSorter[str] = TopologicalSorter()
    for start, end in edges:
        sorter.add(end, start)
    return sorter


def longest_path(lengths: Mapping[Edge, float], ends: Mapping[str, float]) -> tuple[float, list[str]]:
    """Find the longest path in a graph without circles: length and nodes; 0 and none without edges.

    Args:
        lengths: of the edges.
        ends: cost of a node at the start or end of a path.
    """
    before: dict[str, list[str]] = {}
    for start, end in lengths:
        before.setdefault(end, []).append(start)
    best: dict[str, tuple[float, str | None]] = {}
    for node in _sorter(lengths).static_order():
        longer = [(best[other][0] + lengths[other, node], other) for other in before.get(node, [])]
        best[node] = max(longer, default=(ends.get(node, 0.0), None))
    if not best:
        return 0.0, []
    last = max(best, key=lambda node: best[node][0] + ends.get(node, 0.0))
    path = [last]
    while (other := best[path[-1]][1]) is not None:
        path.append(other)
    return best[last][0] + ends.get(last, 0.0), path[::-1]
