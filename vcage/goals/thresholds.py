"""Limits for a true goal and a disturbed object: used to judge the simulator's state, and given to critics."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Thresholds:
    """Limits of the goals' words.

    Args:
        edge_m: an object's centre may be this far outside the opening's rectangle.
        rim_m: an object's bottom is this far below the rim of a deep opening: else it lies across it.
        height_m: an object's bottom may be this far off the floor that carries it: it may lie on another content's
            edge.
        upright_rad: a receptacle that leans more is tipped.
        borne_share: share of an object's weight that the table may bear although it is in or on another one.
        back_m: an object nearer than this to its old place is back there.
        swapped_m: an object nearer than this to where another one stood is in its place.
        away_m: an object was moved away that stands by this farther from the table's middle.
        disturbed_m, tipped_rad: an object that was moved farther, or turned over by more than this, was disturbed.
        opened_share: share of the range beyond which a joint counts as opened, pressed or turned.
        closed_share: share of the range below which it counts as closed.
        weighed_s, scanned_s, handed_s, lifted_s, hit_s, wiped_s: how long an event must go on without a break.
        lifted_m: least height over the table of the bottom of what is in the air.
        shaken_rad, shaken_times: least lean to each side of what is shaken, and the number of leans.
        hit_off_m: the middle of a head is at most this far from the middle of what it hits, seen from above.
        hit_slant_rad: and it faces down to within this.
        hit_moved_m: what is hit stays within this of where it stood, from the touch on to the end of the sub-task.
        wiped_share: share of a flat top that a pad must have passed over: more than half, and less than the 70 % that
            are left between high rims, where the fingers beside the pad need room.
        wiped_gap_m: what lies at most this far from the plane of a pad is under it.
        wiped_m_per_s: and is wiped while the pad moves along it by this or faster: resting on a spot wipes nothing.
        wiped_moved_m, wiped_turned_rad: what is wiped stays within this of where and how it stood.
        poured_rad: least lean of a vessel from which something is poured.
        poured_into_m: side of the smallest opening that is poured into: balls come off a lip up to 2 cm to both sides.
        poured_s: how long all of its contents must have lain in the other thing without a break.
        stood_up_rad: largest lean of an object that was stood up: less than any that falls over keeps.
        hung_m: least height over the table of the lowest point of what hangs.
        inserted_share: least share of the length of a hole that must be filled: more than ManiSkill asks, whose peg
            must come to within 1.5 cm of the middle of the hole.
        inserted_rad, inserted_aside_m: largest angle and distance between its axis and that of the hole: in a hole of
            6 cm that is 3 mm wider all around it leans by 6 degrees at most, and lies 3 mm low.
        still_m_per_s: an object that moves more slowly lies still.
        code_away_m, code_aside_m: a scanner reads a code that is at most this far before its window, and this far
            beside the window's axis.
        code_slant_rad: and turned away from the window by at most this.
        shown_rad: largest angle between where the front of an object faces and the customer, and between its axis and
            upright.
        centred_m: an object whose middle is nearer than this to the centre of the table is there.
        cone_rad: largest angle between the direction of a side (left: −x) and the line between the centres.
        beside_m, near_m: largest gap in the plane between two boxes that are beside, or near, each other.
        row_gap_m, row_off_m: largest gap between neighbours in a row, and between their middles across it.
        inside_m: a box may protrude from its container's box by this, in the plane.
        rest_m: the bottom of a box may be above the top of its support by this.
        centre_share, centre_least_m: largest offset of a box in the middle of another along each axis, as a share of
            that one's size; an offset that always counts as central.
    """

    edge_m: float = 0.005
    rim_m: float = 0.005
    height_m: float = 0.02
    upright_rad: float = math.radians(10)
    borne_share: float = 0.2
    back_m: float = 0.02
    swapped_m: float = 0.03
    away_m: float = 0.1
    disturbed_m: float = 0.05
    tipped_rad: float = math.radians(30)
    opened_share: float = 0.8
    closed_share: float = 0.12
    weighed_s: float = 1.0
    scanned_s: float = 0.25
    handed_s: float = 0.25
    lifted_s: float = 0.4
    lifted_m: float = 0.05
    shaken_rad: float = math.radians(15)
    shaken_times: int = 3
    hit_s: float = 1.5
    hit_off_m: float = 0.02
    hit_slant_rad: float = math.radians(30)
    hit_moved_m: float = 0.02
    wiped_s: float = 1.5
    wiped_share: float = 0.6
    wiped_gap_m: float = 0.005
    wiped_m_per_s: float = 0.01
    wiped_moved_m: float = 0.015
    wiped_turned_rad: float = math.radians(10)
    poured_rad: float = math.radians(75)
    poured_into_m: float = 0.07
    poured_s: float = 0.5
    stood_up_rad: float = math.radians(5)
    hung_m: float = 0.02
    inserted_share: float = 0.75
    inserted_rad: float = math.radians(10)
    inserted_aside_m: float = 0.006
    still_m_per_s: float = 0.01
    code_away_m: float = 0.07
    code_aside_m: float = 0.03
    code_slant_rad: float = math.radians(30)
    shown_rad: float = math.radians(25)
    centred_m: float = 0.1
    cone_rad: float = math.radians(60)
    beside_m: float = 0.10
    near_m: float = 0.20
    row_gap_m: float = 0.08
    row_off_m: float = 0.03
    inside_m: float = 0.005
    rest_m: float = 0.01
    centre_share: float = 0.15
    centre_least_m: float = 0.02


THRESHOLDS = Thresholds()
