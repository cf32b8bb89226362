"""The verdict on an object that an arm lifted, from what the pictures show of it.

Seen from above, an arm hides what it holds, and hides what still lies below it. The customer sees the object before
the arm, and its old place empty below it. The camera on the hand sees if it is between the fingers, and if these touch.
No object is where the table is seen from above; a sure hand may see more of that, for a thing sways in it.
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
        held_share, doubted_share: the same where the camera on the hand surely sees it between the fingers, and where
            that sees nothing like it.
        grasped_share, surely_grasped_share: the same where the fingers are apart with something like it between them,
            and where that surely is the object.
        between_share, between_gain: what counts as something like an object that has left its place: share of the
            pixels between the fingers that must look like it, and, where colours do not tell, by how much less unlike
            it they must be than a bare table.
        elsewhere_share: what is seen so much on its old place, or seen through so much, needs ``seen_share`` even where
            the camera on the hand surely sees it, unless the fingers are apart.
        left_share: share of the old outline that must look as without the object.
        stays_share, agreed_stays_share: share of the pixels that tell the object on its old place from a bare table,
            seen from above, from which it may still stand there; and the same where the camera on the hand sees
            something like it, by ``agreed_gain`` and more, and neither surely it nor the fingers apart.
        lies_share, surely_lies_share: share of the pixels that tell the object where it is put down from which it lies
            there already; and the same where the camera on the hand sees something like it: an arm may hide that place.
        through_share, surely_through_share: share of the pixels that tell it in the air, seen from above, that look
            like the bare table, from which it is not there if a camera is on the hand that does not surely see it; and
            even if that does, where the object does not lean. Without such a camera nothing tells an object that sways
            from one that is gone, and fingers that are apart tell more.
    """

    seen_share: float = 0.5
    held_share: float = 0.3
    doubted_share: float = 0.85
    grasped_share: float = 0.3
    surely_grasped_share: float = 0.2
    between_share: float = 0.2
    between_gain: float = -0.1
    elsewhere_share: float = 0.5
    left_share: float = 0.3
    stays_share: float = 0.6
    agreed_stays_share: float = 0.2
    agreed_gain: float = 0.1
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
            before; where that hardly differs, as after it is put back, the share that has changed; None where that is
            little, too.
        stays: share of what tells it on its old place, seen from above, that looks like it; None where that is little.
        lies: the same of where it is put down afterwards, from above or from the customer's side: the larger.
        seen: largest share of what tells it in the air that looks like it; None where the customer's picture ends
            before its place in the air.
        height: above its old place of that likeliest drawing, metres.
        through: share of what tells that drawing from a bare table, seen from above, that looks like the table.
        hand: what the camera on the hand sees; None without one.
        touch: True where that camera sees the fingers touching, False where it sees them apart, None where it does not
            tell.
        old, new: where it stood and stands; None where it is not found.
    """

    vacated: float | None
    stays: float | None
    lies: float
    seen: float | None
    height: float
    through: float
    hand: InHand | None
    touch: bool | None
    old: Standing
    new: Standing | None

    def verdict(self, thing: str, seen_share: float = SETTINGS.seen_share, leans: bool = False) -> Verdict:
        """Judge if the object was in the air.

        Args:
            thing: words for the object.
            seen_share: least share of the pixels that tell it that must look like it, where the hand does not tell.
            leans: True where it is not upright, as it is drawn.
        """
        refusal = self._not_in_the_air(thing, leans)
        if refusal is not None:
            return refusal
        by_hand = f"the camera on the hand sees {'it' if self.seen else f'the {thing}'} between the fingers"
        if self.seen is None:
            sure = self._grasped and self._held
            words = f"{by_hand}, and its place is empty" if sure else f"no picture shows the {thing} in the air"
            return decided(sure, words, 0.6, "lost")
        words = f"{100 * self.seen:.0f} % of the {thing} is seen {100 * self.height:.0f} cm above its place"
        least = self._least(seen_share)
        if self.seen >= least and self._held:
            words += f", and {by_hand}"
        return decided(self.seen >= least, words, 0.5 + abs(self.seen - least) / 2, "lost")

    @property
    def _held(self) -> bool:
        """True where the hand surely holds it."""
        return self.hand is not None and self.hand.is_sure

    @property
    def _agreed(self) -> bool:
        """True where the camera on the hand sees something like it."""
        return self.hand is not None and self.hand.agrees

    @property
    def _left(self) -> bool:
        """True where the customer sees its old place empty."""
        return self.vacated is not None and self.vacated >= SETTINGS.left_share

    @property
    def _grasped(self) -> bool:
        """True where the fingers are apart, with something like it between them. If it has left its place, something a
        little like it is enough: what is printed on it shifts with the hold."""
        if self.touch is not False or self.hand is None:
            return False
        share, gain = self.hand.share, self.hand.gain
        alike = gain >= SETTINGS.between_gain if share is None else share >= SETTINGS.between_share
        return self._agreed or (self._left and alike)

    def _not_in_the_air(self, thing: str, leans: bool) -> Verdict | None:
        """A no because it is seen elsewhere, or not in the hand; None where nothing speaks against it."""
        return (
            self._not_in_the_hand(thing)
            or self._in_its_place(thing)
            or self._seen_through(thing, leans)
            or self._on_the_table(thing)
        )

    def _not_in_the_hand(self, thing: str) -> Verdict | None:
        """A no because the hand holds nothing, or another thing; None where it may hold it."""
        if self.touch:
            return refused("the fingers have closed on nothing", 0.9, "lost")
        if self.hand is not None and self.hand.contradicts and not self._grasped:
            return refused(f"the camera on the hand does not see the {thing} between the fingers", 0.8, "lost")
        return None

    def _in_its_place(self, thing: str) -> Verdict | None:
        """A no because nothing shows that it left its place; None where something does."""
        if self._left or (self.vacated is None and self._is_away):
            return None
        if self.vacated is None:
            return refused(f"nothing shows that the {thing} left its place", 0.6, "lost")
        return refused(f"the {thing} stands where it was at the moment of the lift", 1 - self.vacated, "lost")

    @property
    def _is_away(self) -> bool:
        """True where it is seen from above that its old place is empty, and the hand sees it."""
        if self._held:
            return self.stays is None or self.stays < SETTINGS.stays_share
        if self.hand is None or self.stays is None or self.hand.contradicts:
            return False
        most = SETTINGS.stays_share if self._grasped else SETTINGS.agreed_stays_share
        return self.hand.gain >= SETTINGS.agreed_gain and self.stays < most

    def _seen_through(self, thing: str, leans: bool) -> Verdict | None:
        """A no because the table is seen where it would be; None where it may be there."""
        if self.hand is None or self._grasped or (self._held and leans):
            return None
        if self.through < (SETTINGS.surely_through_share if self._held else SETTINGS.through_share):
            return None
        return refused(f"the table is seen where the {thing} would be in the air", self.through, "lost")

    def _on_the_table(self, thing: str) -> Verdict | None:
        """A no because it lies where it is put down; None where it may be held."""
        if self._held or self.lies < (SETTINGS.surely_lies_share if self._agreed else SETTINGS.lies_share):
            return None
        return refused(f"the {thing} lies on the table at the moment of the lift", self.lies, "lost")

    def _least(self, seen_share: float) -> float:
        """Least share of the pixels that tell it that must look like it."""
        if self.hand is None:
            return seen_share
        if self._grasped:
            return SETTINGS.surely_grasped_share if self._held else SETTINGS.grasped_share
        elsewhere = max(self.stays or 0.0, self.through) >= SETTINGS.elsewhere_share
        if self._held and self.vacated is not None and not elsewhere:
            return min(seen_share, SETTINGS.held_share)
        return seen_share if self._held or self._agreed else SETTINGS.doubted_share
