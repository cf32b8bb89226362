"""The verdict on an object that an arm lifted, from what the pictures show of it.

Seen from above, an arm hides what it holds, and hides what still lies below it. The customer sees the object before
the arm, and its old place empty below it. The camera on the hand sees whether it is between the fingers, and whether
these touch. Where the table is seen from above, no object is there; more of that is allowed where the camera on the
hand is sure, because an object sways. Where the fingers are apart with something like the object between them, weaker
evidence is enough elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

from vcage.models.rules.evidence.in_hand import InHand
from vcage.models.rules.evidence.judgement import decided, refused
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict


@dataclass(frozen=True)
class RaisedSettings:
    """Limits for a yes.

    Args:
        seen_share: share of the pixels that tell the object from what was there before that must look like it.
        held_share, doubted_share: the same where it has left its place and the camera on the hand surely sees it, or
            where fingers that are apart have something like it between them; and where that camera sees nothing like
            it.
        elsewhere_share: from this share seen on its old place, where it is put down, or seen through, ``seen_share``
            applies even where the camera on the hand sees it; where the fingers are apart, ``surely_through_share`` is
            the limit for the last.
        left_share: share of the old outline that must look as without the object. Of 744 moments of a lift or a shake,
            all but 2 had at least 42 %; of 18 things gripped and not lifted, none had more than 20 %.
        changed_share: share of what showed the object there that must have changed, where no picture shows that place
            without it.
        stays_share, clear_share: share of the pixels that tell the object on its old place from a bare table, seen from
            above, from which it may still stand there; and below which it surely does not, if no hand hides it.
        plain_share: share of the object that must be seen in the air where ``stays`` is between these two.
        agreed_gain: by how much less unlike what is in the hand must be to the object than to a bare table, where the
            old place alone, seen from above, tells that it left.
        alike_share, alike_gain: what counts as a little like an object that has left its place: share of the pixels
            between the fingers that must look like it, and, where colours do not tell, by how much less unlike it they
            must be than a bare table: printed sides may be a little more unlike.
        lies_share, surely_lies_share: share of the pixels that tell the object where it is put down from which it lies
            there already; and the same where the camera on the hand sees something like it: an arm may hide that place.
        through_share, surely_through_share: share of the pixels that tell it in the air, seen from above, that look
            like the bare table, from which it is not there if a camera is on the hand that does not surely see it; and
            even if that does, where the object does not lean. Without such a camera, nothing distinguishes an object
            that sways from one that is gone. Neither limit applies where the fingers are apart with something like it
            between them.
    """

    seen_share: float = 0.5
    held_share: float = 0.3
    doubted_share: float = 0.85
    elsewhere_share: float = 0.5
    left_share: float = 0.4
    changed_share: float = 0.55
    stays_share: float = 0.6
    clear_share: float = 0.2
    plain_share: float = 0.7
    agreed_gain: float = 0.1
    alike_share: float = 0.2
    alike_gain: float = -0.1
    lies_share: float = 0.55
    surely_lies_share: float = 0.75
    through_share: float = 0.6
    surely_through_share: float = 0.85


SETTINGS = RaisedSettings()


@dataclass(frozen=True)
class Raised:
    """Measurements of an object at a moment.

    Args:
        vacated: share of its old outline, where it is not in the air, that looks as it does afterwards, and not as
            before; None where that hardly differs, as after it is put back, and where it is still in the air.
        changed: share of the pixels that showed it there and differ from its surroundings that have changed; None where
            these are few.
        stays: share of what tells it on its old place, seen from above, that looks like it; None where that is little.
        lies: the same of where it is put down afterwards, from above or from the customer's side: the larger.
        seen: largest share of what tells it in the air that looks like it.
        height: above its old place of that likeliest drawing, metres.
        is_shown: False if the customer's picture cuts off most of it at every height.
        through: share of what tells that drawing from a bare table, seen from above, that looks like the table.
        hand: what the camera on the hand sees; None without one.
        fingers_touch: True where that camera sees the fingers touching, False where it sees them apart, None where it
            does not tell.
        old, new: where it stood and stands; None where it is not found.
    """

    vacated: float | None
    changed: float | None
    stays: float | None
    lies: float
    seen: float
    height: float
    is_shown: bool
    through: float
    hand: InHand | None
    fingers_touch: bool | None
    old: Standing
    new: Standing | None

    def verdict(self, thing: str, seen_share: float = SETTINGS.seen_share, leans: bool = False) -> Verdict:
        """Judge if the object was in the air.

        Args:
            thing: words for the object.
            seen_share: least share of the pixels that tell it that must look like it, where the hand does not tell.
            leans: True where it is not upright, as it is drawn.
        """
        refusal = (
            self._not_in_the_hand(thing)
            or self._in_its_place(thing)
            or self._seen_through(thing, leans)
            or self._on_the_table(thing)
        )
        if refusal is not None:
            return refusal
        words = f"{100 * self.seen:.0f} % of the {thing} is seen {100 * self.height:.0f} cm above its place"
        least = self._least(seen_share)
        if self.seen < least and self._is_beside_the_picture:
            by_hand = f"the camera on the hand sees the {thing} between the fingers, and its place is empty"
            return decided(True, f"{by_hand}; the customer's picture ends before it", 0.6, "lost")
        if self.seen >= least and self._is_held:
            words += ", and the camera on the hand sees it between the fingers"
        return decided(self.seen >= least, words, 0.5 + abs(self.seen - least) / 2, "lost")

    @property
    def _is_held(self) -> bool:
        """True where the camera on the hand surely sees it."""
        return self.hand is not None and self.hand.is_sure

    @property
    def _may_be_held(self) -> bool:
        """True where that camera sees something like it."""
        return self.hand is not None and self.hand.agrees

    @property
    def _is_gripped(self) -> bool:
        """True where the fingers are apart with something like it between them. If it has left its place, something a
        little like it is enough: what is printed on it shifts with the hold."""
        if self.fingers_touch is not False or self.hand is None:
            return False
        share, gain = self.hand.share, self.hand.gain
        alike = gain >= SETTINGS.alike_gain if share is None else share >= SETTINGS.alike_share
        return self._may_be_held or (self._has_left and alike)

    @property
    def _has_left(self) -> bool:
        """True where the customer sees its old place empty, or changed."""
        if self.vacated is None:
            return self.changed is not None and self.changed >= SETTINGS.changed_share
        return self.vacated >= SETTINGS.left_share

    @property
    def _is_clear(self) -> bool:
        """True where its old place is seen empty from above."""
        return self.stays is not None and self.stays < SETTINGS.clear_share

    @property
    def _is_away(self) -> bool:
        """True where the hand sees it and its old place does not speak against that: seen empty from above, or unclear
        while it is plainly seen in the air. A sure hand is enough where the view from above does not tell."""
        if self.hand is None:
            return False
        if self._is_held and self.stays is None:
            return True
        plainly = self.stays is not None and self.stays < SETTINGS.stays_share and self.seen >= SETTINGS.plain_share
        if self._is_held:
            return self._is_clear or plainly
        agreed = not self.hand.contradicts and self.hand.gain >= SETTINGS.agreed_gain
        return agreed and (self._is_clear or (plainly and self._is_gripped))

    @property
    def _is_beside_the_picture(self) -> bool:
        """True where the hand tells of what is in the air beside the customer's picture."""
        return not self.is_shown and self._is_held and self._is_gripped and self._is_clear

    def _not_in_the_hand(self, thing: str) -> Verdict | None:
        """A no because the hand holds nothing, or another thing; None where it may hold it."""
        if self.fingers_touch:
            return refused("the fingers have closed on nothing", 0.9, "lost")
        if self.hand is not None and self.hand.contradicts and not self._is_gripped:
            return refused(f"the camera on the hand does not see the {thing} between the fingers", 0.8, "lost")
        return None

    def _in_its_place(self, thing: str) -> Verdict | None:
        """A no because it is in its old place, or nothing shows that it left that; None where something does."""
        if self._has_left:
            return None
        left = self.changed if self.vacated is None else self.vacated
        if left is not None:
            return refused(f"the {thing} stands where it was", 1 - left, "lost")
        return None if self._is_away else refused(f"nothing shows that the {thing} left its place", 0.6, "lost")

    def _seen_through(self, thing: str, leans: bool) -> Verdict | None:
        """A no because the table is seen where it would be; None where it may be there."""
        if self.hand is None or self._is_gripped or (self._is_held and leans):
            return None
        if self.through < (SETTINGS.surely_through_share if self._is_held else SETTINGS.through_share):
            return None
        return refused(f"the table is seen where the {thing} would be in the air", self.through, "lost")

    def _on_the_table(self, thing: str) -> Verdict | None:
        """A no because it lies where it is put down; None where it may be held."""
        if self._is_held or self.lies < (SETTINGS.surely_lies_share if self._may_be_held else SETTINGS.lies_share):
            return None
        return refused(f"the {thing} lies on the table at the moment of the lift", self.lies, "lost")

    @property
    def _is_elsewhere(self) -> bool:
        """True where it may be elsewhere than in the air: on its old place, where it is put down, or gone."""
        through = SETTINGS.surely_through_share if self._is_gripped else SETTINGS.elsewhere_share
        on_table = max(self.stays or 0.0, self.lies) >= SETTINGS.elsewhere_share
        return on_table or self.through >= through

    def _least(self, seen_share: float) -> float:
        """Least share of the pixels that tell it that must look like it."""
        if self.hand is None:
            return seen_share
        if (self._is_gripped or (self._is_held and self._has_left)) and not self._is_elsewhere:
            return min(seen_share, SETTINGS.held_share)
        return seen_share if self._is_held or self._may_be_held else SETTINGS.doubted_share
