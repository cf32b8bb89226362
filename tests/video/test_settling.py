"""Held-out frames, which no search has seen."""

from __future__ import annotations

from vcage.video.settling import held_out_frames


def test_one_of_every_ten_frames_is_held_out_unless_it_was_scored():
    assert held_out_frames(40, [16]) == [3, 29, 32]


def test_even_a_short_clip_has_held_out_frames_that_are_no_keyframes():
    assert held_out_frames(13, [0, 12]) == [3, 10]
    assert held_out_frames(1, [0]) == []


def test_held_out_frames_do_not_keep_step_with_any_gop():
    places = held_out_frames(100, [])
    assert sorted(place % 10 for place in places) == list(range(10))
