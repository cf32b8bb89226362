"""JSON and YAML that other programs and editors wrote."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import pytest

from vcage.base.errors import DamagedFile, InputFileError, MissingStage, OversizedFile
from vcage.base.reading import (
    DocumentLimits,
    Unreadable,
    load_json,
    open_regular,
    parse_json,
    read_json,
    read_yaml,
    text_of,
)


def test_a_byte_order_mark_and_line_ends_of_windows_are_taken(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_bytes(b'\xef\xbb\xbf{\r\n  "a": "\xc3\xbc"\r\n}\r\n')
    (tmp_path / "a.yml").write_bytes(b"\xef\xbb\xbfa: \xc3\xbc\r\nb: 2\r\n")
    assert read_json(tmp_path / "a.json") == {"a": "ü"}
    assert read_yaml(tmp_path / "a.yml") == {"a": "ü", "b": 2}


@pytest.mark.parametrize(
    ("data", "line", "why"),
    [
        (b'{"a": 1,\n "b": {"a": 2},\n "a": 3}', 3, "the key 'a' stands twice"),
        (b'{"x": [{"a\\u0062": 1,\n"ab" : 2}], "x": 1}', 2, "the key 'ab' stands twice"),
        (b'{"text": "NaN, -Infinity",\n"a": NaN}', 2, "NaN is no number"),
        (b'{"a":\n-Infinity}', 2, "-Infinity is no number"),
        (b"[\n" * 100_000, 201, "inside each other"),
        (b'{"a":\n' * 250 + b"1" + b"}" * 250, 201, "inside each other"),
        (b'{"a":\n\n"\xe9"}', 3, "0xe9 is not UTF-8"),
        ('{"a": 1}'.encode("utf-16"), 1, "UTF-16"),
        ('{"a": 1}'.encode("utf-16-be"), 1, "UTF-16"),
        (b'{"a":\n' + b"1" * 5000 + b"}", 2, "thousands of digits"),
        (b'{"a": 1,\n}', 2, "property name"),
        (b"", 1, "Expecting value"),
    ],
)
def test_broken_json_is_refused_by_its_line(data: bytes, line: int, why: str, tmp_path: Path) -> None:
    path = tmp_path / "asset.json"
    path.write_bytes(data)
    with pytest.raises(DamagedFile, match=rf"asset\.json is not valid JSON: line {line}: .*{why}") as caught:
        read_json(path)
    assert caught.value.details["line"] == line


@pytest.mark.parametrize(
    ("data", "line"),
    [(b"a: 1\nb: 2\na: 3", 3), (b"a: [\n1", 2), (b"a: 1\nb: \x01", 2), (b"[\n" * 100_000, 201), (b"a: 2020-99-99", 1)],
)
def test_broken_yaml_is_refused_by_its_line(data: bytes, line: int, tmp_path: Path) -> None:
    path = tmp_path / "robot.yml"
    path.write_bytes(data)
    with pytest.raises(DamagedFile, match=rf"robot\.yml is not valid YAML: line {line}: "):
        read_yaml(path)


def test_no_garbage_is_collected_while_json_is_parsed() -> None:
    collects = []
    load_json("{}", object_hook=lambda _: collects.append(gc.isenabled()))
    with pytest.raises(RecursionError):
        load_json("[" * 100_000)
    assert (collects, gc.isenabled()) == ([False], True)


def test_not_a_number_is_taken_where_it_is_asked_for() -> None:
    assert parse_json('{"std": [Infinity]}', nan=True) == {"std": [float("inf")]}


def test_text_in_another_encoding_is_refused() -> None:
    with pytest.raises(Unreadable, match="line 2: byte 0xfc is not UTF-8"):
        text_of(b"first\nfr\xfch")


def test_a_pipe_a_device_and_a_folder_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "endless").symlink_to("/dev/zero")
    (tmp_path / "folder").mkdir()
    for name in ("pipe", "endless", "folder"):
        with pytest.raises(InputFileError, match=f"{name} is a (device|pipe|folder), not a JSON file"):
            read_json(tmp_path / name)


def test_a_missing_file_and_one_that_is_too_long_are_named(tmp_path: Path) -> None:
    with pytest.raises(MissingStage, match=r"none\.json does not exist"):
        read_json(tmp_path / "none.json")
    (tmp_path / "long.json").write_bytes(b"[1, 2]")
    with pytest.raises(OversizedFile, match=r"long\.json is too large: 6 of at most 5 bytes"):
        open_regular(tmp_path / "long.json", "a JSON file", DocumentLimits(max_bytes=5).max_bytes)


def test_data_nested_up_to_the_limit_is_read() -> None:
    assert parse_json("[" * 200 + "]" * 200)


def test_a_file_that_breaks_off_while_it_is_read_is_named() -> None:
    with pytest.raises(InputFileError, match=r"/proc/self/mem cannot be read: .*Input/output error"):
        read_json(Path("/proc/self/mem"))  # at its beginning nothing is mapped
