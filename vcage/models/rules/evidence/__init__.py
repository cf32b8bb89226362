"""Judgements of the offline critic, one file each: the measurements in pictures, and the conditions of a yes.

A kind of goal names its judgement (``evidence`` of :class:`vcage.goals.kind.GoalKind`).
"""

from __future__ import annotations

from vcage.models.rules.evidence.handed import judge_handed
from vcage.models.rules.evidence.held_up import judge_held_by_both, judge_held_up
from vcage.models.rules.evidence.hit import judge_hit
from vcage.models.rules.evidence.hung import judge_hung
from vcage.models.rules.evidence.in_the_air import judge_lifted
from vcage.models.rules.evidence.inserted import judge_inserted
from vcage.models.rules.evidence.judgement import Judgement
from vcage.models.rules.evidence.moved import (
    judge_centred,
    judge_in_place_of,
    judge_moved,
    judge_moved_away,
    judge_presented,
    judge_related,
    judge_returned,
)
from vcage.models.rules.evidence.parts import judge_part
from vcage.models.rules.evidence.placed import judge_placed, judge_weighed
from vcage.models.rules.evidence.poured import judge_poured
from vcage.models.rules.evidence.pressed import judge_pressed
from vcage.models.rules.evidence.scanned import judge_scanned
from vcage.models.rules.evidence.shaken import judge_shaken
from vcage.models.rules.evidence.upright import judge_upright
from vcage.models.rules.evidence.wiped import judge_wiped

EVIDENCE: dict[str, Judgement] = {
    "part": judge_part,
    "pressed": judge_pressed,
    "placed": judge_placed,
    "moved": judge_moved,
    "related": judge_related,
    "centred": judge_centred,
    "in_place_of": judge_in_place_of,
    "moved_away": judge_moved_away,
    "presented": judge_presented,
    "facing_robot": judge_presented,
    "returned": judge_returned,
    "scanned": judge_scanned,
    "weighed": judge_weighed,
    "lifted": judge_lifted,
    "held_up": judge_held_up,
    "held_by_both": judge_held_by_both,
    "shaken": judge_shaken,
    "handed": judge_handed,
    "hit": judge_hit,
    "wiped": judge_wiped,
    "poured": judge_poured,
    "upright": judge_upright,
    "hung": judge_hung,
    "inserted": judge_inserted,
}
"""By the name of the evidence."""
