"""JSON and YAML as other programs write them, and errors that name file and line where they cannot be read.

A byte order mark and Windows' line ends are accepted. Inputs that Python reads silently are refused: a repeated
key, of which the last would win; ``NaN``; text in another encoding; a pipe or device, which need never end.
"""

from __future__ import annotations

import gc
import io
import json
import re
import stat
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from vcage.base.errors import DamagedFile, InputFileError, MissingStage, OversizedFile


@dataclass(frozen=True)
class DocumentLimits:
    """The largest JSON or YAML file that is read.

    Args:
        max_bytes: of the file.
        max_depth: lists and objects inside each other.
    """

    max_bytes: int = 1_000_000_000
    max_depth: int = 200


LIMITS = DocumentLimits()

_TOO_DEEP = f"more than {LIMITS.max_depth} lists or objects inside each other"


class Unreadable(ValueError):
    """Text is invalid; the message names the line."""

    def __init__(self, line: int, why: str):
        super().__init__(f"line {line}: {why}")
        self.line, self.why = line, why


KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
"""Type in a file's mode → what it is."""


def kind_of_file(mode: int) -> str:
    """Name the kind of an irregular file, by the mode in its ``stat``."""
    return KINDS.get(stat.S_IFMT(mode), "something else")


def open_regular(path: Path, what: str, max_bytes: int, maker: str = "") -> io.BufferedReader:
    """Open a file of limited length for reading; no pipe, socket or device.

    Args:
        path: of the file.
        what: it should be, with its article.
        max_bytes: its longest length.
        maker: the stage that writes it.

    Raises:
        MissingStage: it is not there.
        DamagedFile: it is a folder.
        OversizedFile: it is longer.
        InputFileError: it is a pipe, a socket or a device, or may not be read.
    """
    try:
        found = path.stat()
        if stat.S_ISDIR(found.st_mode):
            hint = "move it away and run the stage again" if maker else "name a file"
            raise DamagedFile(f"{path} is a folder, not {what}", hint=hint, maker=maker)
        if not stat.S_ISREG(found.st_mode):
            raise InputFileError(f"{path} is {kind_of_file(found.st_mode)}, not {what}", hint="save it as a file")
        if found.st_size > max_bytes:
            raise OversizedFile(
                f"{path} is too large: {found.st_size:,} of at most {max_bytes:,} bytes",
                hint="give a smaller file",
                maker=maker,
                details={"path": str(path)},
            )
        return path.open("rb")
    except (FileNotFoundError, NotADirectoryError) as error:
        hint = "the stage that writes it comes first" if maker else "check the path"
        raise MissingStage(f"{path} does not exist", hint=hint, maker=maker) from error
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise InputFileError(f"{path} cannot be read: {error}", hint="make it readable") from error


def read_regular(path: Path, what: str, maker: str = "") -> bytes:
    """Read a whole file of at most ``LIMITS.max_bytes``; arguments and errors as :func:`open_regular`."""
    with open_regular(path, what, LIMITS.max_bytes, maker) as handle:
        try:
            return handle.read()
        except OSError as error:  # of a disk, or of a file server that is gone
            raise InputFileError(f"{path} cannot be read: {error}", hint="make it readable") from error


def read_json(path: Path, maker: str = "", *, nan: bool = False) -> Any:
    """Read a JSON file.

    Args:
        path: of the file.
        maker: the stage that writes it.
        nan: ``NaN`` and ``Infinity``, which are not JSON, are accepted.

    Raises:
        InputFileError: as :func:`open_regular`.
        DamagedFile: it is not JSON; names the line.
    """
    return _read(path, "JSON", lambda data: parse_json(data, nan=nan), maker)


def read_yaml(path: Path) -> Any:
    """Read a YAML file; raises as :func:`read_json`."""
    return _read(path, "YAML", _parse_yaml, "")


def _read(path: Path, what: str, parse: Callable[[bytes], Any], maker: str) -> Any:
    data = read_regular(path, f"a {what} file", maker)
    try:
        return parse(data)
    except Unreadable as error:
        raise DamagedFile(
            f"{path} is not valid {what}: {error}",
            hint="fix it",
            maker=maker,
            details={"path": str(path), "line": error.line},
        ) from error


def text_of(data: bytes) -> str:
    """Text in UTF-8, without its byte order mark.

    Raises:
        Unreadable: it is in another encoding.
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")) or b"\0" in data[:4]:
        raise Unreadable(1, "it is UTF-16 or UTF-32; save it as UTF-8 (PowerShell: Set-Content -Encoding utf8)")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise Unreadable(line, f"byte 0x{data[error.start]:02x} is not UTF-8; save it as UTF-8") from error


def parse_json(data: bytes | str, *, nan: bool = False) -> Any:
    """The value of a JSON text.

    Args:
        data: the text, or its bytes; a byte order mark is dropped.
        nan: ``NaN`` and ``Infinity`` are taken.

    Raises:
        Unreadable: it is not JSON, says a key of an object twice, or is nested too deeply.
    """
    text = text_of(data) if isinstance(data, bytes) else data.removeprefix("\ufeff")
    try:
        value = load_json(text, object_pairs_hook=_object, parse_constant=None if nan else _no_constant)
        if _is_deep(value, LIMITS.max_depth):  # writing it again would reach Python's own limit
            raise RecursionError
        return value
    except _Twice:
        line, name = _second_key(text)
        raise Unreadable(line, f"the key {name[:80]!r} stands twice in one object") from None
    except _Constant as error:
        raise Unreadable(_line_of_token(text, str(error)), f"{error} is no number of JSON") from None
    except RecursionError:
        raise Unreadable(_line_of_depth(text, LIMITS.max_depth), _TOO_DEEP) from None
    except json.JSONDecodeError as error:
        raise Unreadable(error.lineno, f"{error.msg} (column {error.colno})") from error
    except ValueError as error:  # Python's own limit
        raise Unreadable(_line_of_token(text, r"\d{4000,}"), "a number of thousands of digits") from error


def load_json(text: bytes | str, **hooks: Any) -> Any:
    """``json.loads`` without collections of garbage.

    At the recursion limit, which deep text reaches, a collection would run finalizers that then fail.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        return json.loads(text, **hooks)
    finally:
        if collects:
            gc.enable()


class _Twice(Exception):
    """A key that stands twice in an object."""


class _Constant(Exception):
    """``NaN``, ``Infinity`` or ``-Infinity``."""


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise _Twice
    return found


def _is_deep(value: Any, depth: int) -> bool:
    """Check for more than ``depth`` lists and objects inside each other."""
    level = [value]
    for _ in range(depth + 1):
        level = [item for item in level if isinstance(item, (list, dict))]
        level = [inner for item in level for inner in (item.values() if isinstance(item, dict) else item)]
        if not level:
            return False
    return True


def _no_constant(name: str) -> NoReturn:
    raise _Constant(name)


_STRING = r'"[^"\\]*(?:\\.[^"\\]*)*"'


def _line(text: str, position: int) -> int:
    return text.count("\n", 0, position) + 1


def _line_of_token(text: str, token: str) -> int:
    """Line of the first match of a pattern outside strings; 1 where there is none."""
    found = (match for match in re.finditer(rf"{_STRING}|({token})", text) if match[1])
    return _line(text, next((match.start() for match in found), 0))


def _line_of_depth(text: str, depth: int) -> int:
    """Line with that many lists and objects open."""
    level = 0
    for match in re.finditer(rf"{_STRING}|[\[{{}}\]]", text):
        level += {"[": 1, "{": 1, "]": -1, "}": -1}.get(match[0], 0)
        if level > depth:
            return _line(text, match.start())
    return 1


def _second_key(text: str) -> tuple[int, str]:
    """The first repeated key of an object, and its line, of a text that is JSON up to there."""
    objects: list[set[str]] = []
    for match in re.finditer(rf"({_STRING})\s*:|{_STRING}|[{{}}]", text):
        if match[0] == "{":
            objects.append(set())
        elif match[0] == "}":
            objects.pop()
        elif match[1]:
            name = json.loads(match[1])
            if name in objects[-1]:
                return _line(text, match.start()), name
            objects[-1].add(name)
    return 1, ""


def _parse_yaml(data: bytes) -> Any:
    import yaml

    text = text_of(data)
    try:
        return yaml.load(text, _yaml_loader())
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise Unreadable(mark.line + 1 if mark else 1, str(error.problem or error.context)) from error
    except yaml.reader.ReaderError as error:
        raise Unreadable(_line(text, error.position), f"{error.reason} ({error.character!r})") from error
    except RecursionError:
        raise Unreadable(1, _TOO_DEEP) from None
    except ValueError as error:  # a date that cannot be
        raise Unreadable(1, str(error)) from error


@cache
def _yaml_loader() -> type[Any]:
    """The class of the YAML reader; made when it is first needed, as yaml is slow to import."""
    import yaml

    class Loader(yaml.SafeLoader):
        """Refuses a repeated key of a mapping, and brackets whose nesting takes quadratic time."""

        def fetch_flow_collection_start(self, token: type[yaml.Token]) -> None:  # pyrefly: ignore
            if self.flow_level >= LIMITS.max_depth:
                raise yaml.scanner.ScannerError(problem=_TOO_DEEP, problem_mark=self.get_mark())
            super().fetch_flow_collection_start(token)

        def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
            seen = set()
            for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode) and key.value != "<<"):
                if (key.tag, key.value) in seen:
                    problem = f"the key {key.value[:80]!r} stands twice in one mapping"
                    raise yaml.constructor.ConstructorError(problem=problem, problem_mark=key.start_mark)
                seen.add((key.tag, key.value))
            return super().construct_mapping(node, deep)

    return Loader
