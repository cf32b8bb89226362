"""The figures of a benchmark as text."""

from __future__ import annotations

from benchmarks._table import cell, lines, table


def test_columns_are_aligned_and_names_stand_over_their_figures() -> None:
    rows = [{"method": "ours", "ms_p50": 4.25, "ok": True}, {"method": "another", "ms_p50": None, "ok": False}]
    assert list(table(rows)) == [
        "           ms",
        "method    p50   ok",
        "ours     4.25  yes",
        "another     -   no",
    ]


def test_a_row_that_lacks_a_figure_shows_a_dash() -> None:
    assert [line.split() for line in table([{"n": 4}, {"n": 10, "ms": 2.0}])] == [["n", "ms"], ["4", "-"], ["10", "2"]]


def test_figures_without_rows_are_one_row() -> None:
    assert [line.split() for line in lines({"recall": 0.5, "precision": 1.0})] == [
        ["recall", "precision"],
        ["0.5", "1"],
    ]


def test_metadata_follows_the_rows() -> None:
    text = list(lines({"rows": [{"n": 1}], "seeds": 50, "goals": {"kept": 0.999}}))
    assert [line.split() for line in text] == [["n"], ["1"], ["seeds", "50"], ["goals.kept", "0.999"]]


def test_lists_of_records_and_records_of_records_are_tables_of_their_own() -> None:
    text = list(lines({"rows": [{"n": 1}], "cases": [{"id": "a", "n": 2}], "by_kind": {"x": {"n": 3}, "y": {"n": 4}}}))
    assert [line.split() for line in text] == [
        ["n"], ["1"], [], ["cases:"], ["id", "n"], ["a", "2"], [], ["by_kind:"], ["kind", "n"], ["x", "3"], ["y", "4"],
    ]  # fmt: skip


def test_no_rows_make_no_table() -> None:
    assert list(lines({"rows": []})) == []


def test_small_and_large_numbers_keep_their_digits() -> None:
    assert [cell(x) for x in (0.0001, 1234.5, 7, "text")] == ["0.0001", "1234.5", "7", "text"]
