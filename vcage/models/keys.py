"""Keys of model endpoints, and the user's files beside the repository; a key is never logged, printed or written."""

from __future__ import annotations

import logging
import os
import shlex
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from vcage.base.errors import ConfigurationError, InputFileError, MissingKey, MissingStage
from vcage.base.reading import read_json
from vcage.models.provider import Provider

logger = logging.getLogger(__name__)


def variables(provider: Provider) -> tuple[str, ...]:
    """The environment variables for the provider's key, in the order of reading.

    The project's own name comes first: agents strip the well-known names from the commands that they run.
    """
    return (f"VCAGE_{provider.name.upper()}_API_KEY", *provider.key_variables)


def key_file() -> Path:
    """``$VCAGE_KEY_FILE``, else ``~/.config/vcage/keys.json``: ``{"gemini": "…"}``."""
    return user_file("VCAGE_KEY_FILE", "keys.json")


def find_key(provider: Provider) -> tuple[str, str] | None:
    """The provider's key and the name of the place where it was found; None when there is none.

    Raises:
        ConfigurationError: the key file cannot be read.
    """
    for name in variables(provider):
        if value := os.environ.get(name, "").strip():
            return value, name
    if value := _read_key_file().get(provider.name, "").strip():
        return value, str(key_file())
    return None


def require_key(provider: Provider) -> str:
    """The provider's key; empty where it needs none.

    Raises:
        MissingKey: it is nowhere; the hint names the places.
        ConfigurationError: it can be no key.
    """
    if not provider.needs_key:
        return ""
    found = find_key(provider)
    if found is not None and not (found[0].isascii() and found[0].isprintable() and " " not in found[0]):
        raise ConfigurationError(
            f"the key for {provider.name} in {found[1]} holds characters not allowed in a key",
            hint="copy it again: letters, digits and signs, in one line",
        )
    if found is None:
        names = " or ".join(variables(provider))
        raise MissingKey(
            f"no key for {provider.name}",
            hint=f'set {names}, or write {{"{provider.name}": "<key>"}} to {key_file()}, or use --models offline',
            details={"provider": provider.name, "variables": list(variables(provider)), "file": str(key_file())},
        )
    return found[0]


def open_to_others(path: Path) -> bool:
    """Check if other users of the machine may read or write a file; False if there is none."""
    return os.name == "posix" and path.exists() and bool(path.stat().st_mode & 0o077)


@cache
def _warn_of_readers(path: Path) -> None:
    """Warn once in a process that others may read the keys."""
    if open_to_others(path):
        logger.warning("other users may read the keys in %s; run: %s", path, closing_command(path))


def closing_command(path: Path) -> str:
    """The command that closes a file to other users."""
    return shlex.join(["chmod", "600", str(path)])


def _read_key_file() -> dict[str, str]:
    path = key_file()
    keys = read_user_file(path, str, what="keys", example='{"gemini": "<key>"}', secret=True)
    if keys:
        _warn_of_readers(path)
    return keys


def user_file(variable: str, name: str) -> Path:
    """The file that an environment variable names, else ``~/.config/vcage/<name>``."""
    return Path(os.environ.get(variable) or Path.home() / ".config" / "vcage" / name)


def read_user_file(path: Path, values: Any, *, what: str, example: str, secret: bool = False) -> dict[str, Any]:
    """The object in a file of the user; empty if there is no file.

    Args:
        values: the type of its values.
        what: it holds, for errors.
        example: of its JSON, for errors.
        secret: errors must not quote the file.

    Raises:
        ConfigurationError: it cannot be read, or its values are of another type.
    """
    try:
        return TypeAdapter(dict[str, values]).validate_python(read_json(path))
    except MissingStage:
        return {}
    except InputFileError as error:
        line = f", line {error.details['line']}" if "line" in error.details else ""
        reason = "" if secret else f": {error.message}"
    except ValidationError as error:
        first = error.errors()[0]
        line, reason = "", "" if secret else f": {'.'.join(map(str, first['loc']))}: {first['msg']}"
    raise ConfigurationError(
        f"{path} does not hold {what}{line}{reason}", hint=f"write JSON in UTF-8 like {example}, or remove it"
    )
