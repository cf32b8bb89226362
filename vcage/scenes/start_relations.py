"""Start relations of chosen objects: in or on others, in drawers too, as the instruction says; or complaints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.capacities import capacity_of
from vcage.models.selection_check import NamedObject, room_complaints, starting_as_described
from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import Description, part_words
from vcage.schema.scene import ObjectRecord
from vcage.tasks.feasibility import fits
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import point_in


def started(objects: Sequence[NamedObject], descriptions: Sequence[Description], library: Library) -> list[NamedObject]:
    """The objects as they start by the descriptions.

    Raises:
        InfeasibleScene: descriptions contradict each other, or there is no room; names the objects and sizes.
    """
    found, wrong = starting_as_described(objects, descriptions)
    wrong = wrong or start_complaints(found, library)
    if wrong:
        raise InfeasibleScene(
            f"not all can start where the instruction says: {'; '.join(wrong)}",
            hint="ask for a smaller thing, or for a place with more room; another --seed does not help",
            details={"problems": wrong},
        )
    return found


def start_complaints(objects: Sequence[NamedObject], library: Library) -> list[str]:
    """Objects without room where they start, one sentence each."""
    rooms = {o.id: capacity_of(o.id, library.asset(o.asset, o.variant)) for o in objects}
    return [*room_complaints(objects, rooms), *_drawer_complaints(objects, library)]


def _drawer_complaints(objects: Sequence[NamedObject], library: Library) -> Iterator[str]:
    by_id = {o.id: o for o in objects}
    for o in objects:
        if o.starts_in is None or o.starts_in_part is None:
            continue
        holder, thing = (scene_object(one, library.asset(one.asset, one.variant)) for one in (by_id[o.starts_in], o))
        point, part = point_in(holder.asset, o.starts_in_part), part_words(o.starts_in_part)
        above = [other.id for other in objects if other.starts_in == o.id]
        if point is None:
            yield f"{o.id} cannot start in the {part} of {o.starts_in}, where nothing lies"
        elif above:
            yield f"{', '.join(above)} cannot start in or on {o.id}, which starts in the {part} of {o.starts_in}"
        elif not (check := fits(thing, holder, point)).passed:
            yield f"{o.id} has no room where it starts, in the {part} of {o.starts_in}: {check.message}"


def scene_object(o: NamedObject, asset: Asset, pose: Pose | None = None, joints: tuple[float, ...] = ()) -> SceneObject:
    """An object at a pose, with its moving parts at positions; without a pose it lies in nothing, to look at sizes."""
    at = pose or Pose()
    record = ObjectRecord(
        id=o.id,
        asset=o.asset,
        variant=o.variant,
        phrase=o.phrase,
        role=o.role,
        pose=PoseRecord.of(at),
        aabb=box_record(asset.bounds, at),
        joints=joints,
        container=None if pose is None else o.starts_in,
        container_part=None if pose is None else o.starts_in_part,
    )
    return SceneObject(record, asset, at, joints)
