"""Files of the user beside the repository: keys and prices of model endpoints, as JSON."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from vcage.base.errors import ConfigurationError, InputFileError, MissingStage
from vcage.base.reading import read_json


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
        line, reason = "", "" if secret else f": {error.errors()[0]['msg']}"
    raise ConfigurationError(f"{path} holds no {what}{line}{reason}", hint=f"it holds JSON in UTF-8 like {example}")
