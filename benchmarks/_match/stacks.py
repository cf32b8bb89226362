"""Measured stacks: our matcher with a detector and an embedder by name, and the greedy baseline."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable

from benchmarks._match.cases import Case
from benchmarks._match.greedy import match_greedily
from benchmarks._match.scoring import Score, score
from vcage.base.errors import NoRenderer, UnknownName, UsageError
from vcage.models.registry import build_detector, build_embedder, split_weights
from vcage.objects.library import Library
from vcage.schema.matches import Match
from vcage.setup.vulkan import ensure_driver
from vcage.sim.drawer import ModelDrawer
from vcage.vision.match import Looks, Recogniser, match_picture
from vcage.vision.observation import ScenePictures
from vcage.vision.symmetry import rotational_symmetry

OFFLINE = "background+classical"
BASELINE = "greedy-baseline"
"""Greedy pairing (section III-A3 of the paper) on the detections and features of the offline stack. It is not the
paper's system, which uses Grounding DINO and DINOv2."""

Matcher = Callable[[Case], list[Match]]


def build(stack: str) -> Matcher:
    """The matcher of a stack: ``detector+embedder``, each a name or ``name:weights``.

    Raises:
        UsageError: it is not spelled so, or there is no such detector or embedder.
        MissingDependency, InputFileError: a package or the weights are not there.
    """
    detector, plus, embedder = (OFFLINE if stack == BASELINE else stack).partition("+")
    if not plus:
        raise UsageError(f"no stack is called {stack!r}", hint=f"give detector+embedder, as in {OFFLINE}")
    found = build_detector(*split_weights(detector)), build_embedder(*split_weights(embedder))
    if stack == BASELINE:
        return lambda case: match_greedily(case, *found)

    def match(case: Case) -> list[Match]:
        pictures = ScenePictures(case.source, case.segmentation, case.background)
        looks = Looks(symmetries(case), drawer(case))
        return match_picture(case.scene, case.plan, pictures, case.target, Recogniser(*found), looks).matches

    return match


def judge(matcher: Matcher, case: Case) -> Score:
    """The score of a matcher's answer to a case, with the wall time that it took."""
    symmetries(case)  # measured once for every look, as the stage does; not part of a picture's time
    start, start_cpu = time.perf_counter(), time.process_time()
    matches = matcher(case)
    seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - start_cpu
    return score(case.scene, case.truth, matches, seconds, cpu_seconds)


@functools.cache
def _library() -> Library | None:
    """The library that objects are drawn from; None where nothing can draw."""
    try:
        ensure_driver()
    except NoRenderer:
        return None
    return Library.load()


def drawer(case: Case) -> ModelDrawer | None:
    """Draws the objects of a case that the library has, as the stage does; None where nothing can draw."""
    library, models = _library(), {}
    if library is None:
        return None
    for record in case.scene.objects:
        try:
            models[record.id] = library.asset(record.asset, record.variant).model
        except UnknownName:
            continue  # a case made elsewhere: it keeps the heading at which it was found
    return ModelDrawer(models)


_ORDERS: dict[tuple[str, str], int] = {}


def symmetries(case: Case) -> dict[str, int]:
    """Order of symmetry by object id as the stage measures it, for the objects that the case has a reference of."""
    orders = {}
    for record in case.scene.objects:
        if record.id in case.references:
            look = (record.asset, record.variant)
            if look not in _ORDERS:
                _ORDERS[look] = rotational_symmetry(case.references[record.id])
            orders[record.id] = _ORDERS[look]
    return orders
