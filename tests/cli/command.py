"""A command that is run in this process."""

from __future__ import annotations

import json
from typing import Any

import pytest

from vcage.cli.main import main


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, dict[str, Any], str]:
    """Exit code, the last line as a record, and the lines before it."""
    code = main([str(x) for x in arguments])
    *lines, last = capsys.readouterr().out.splitlines()
    return code, json.loads(last), "\n".join(lines)
