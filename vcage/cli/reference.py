"""The page about all commands, made from their own help: ``python -m vcage.cli.reference > docs/cli.md``."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from unittest import mock

from vcage.cli.main import COMMANDS, help_text, main

WIDTH = 100
"""Columns of the help texts, so that the page does not depend on a terminal."""

INTRODUCTION = """\
# Commands

<!-- Made by `python -m vcage.cli.reference > docs/cli.md`; do not edit. -->

```text
{help}
```

## Output and exit codes

Progress and diagnostics go to stderr. The last line of stdout is one JSON object:
`{{"ok": true, "schema", "output", "summary", "next"}}`, or
`{{"ok": false, "error": {{"code", "message", "hint", "retryable", "details"}}}}`; an error is also one line on stderr.

| exit code | meaning |
|---|---|
| 0 | done |
| 1 | a bug in vcage |
| 2 | the request cannot be met: usage, unknown name, no asset fits, no room, output not writable |
| 3 | an input file is missing, damaged, stale, or of another schema |
| 4 | a key, package or driver is missing |
| 5 | the model refused, finally |
| 6 | the endpoint failed for now; try again |
| 7 | partly done, or the disk is full; the same command goes on |
| 130 | interrupted; the same command goes on |
"""

SECTION = """
## vcage {name}

```text
{help}
```
"""


def reference() -> str:
    """The whole page."""
    page = INTRODUCTION.format(help=help_text().strip())
    return page + "".join(SECTION.format(name=name, help=_help(name)) for name in COMMANDS)


def _help(command: str) -> str:
    printed = io.StringIO()
    with mock.patch.dict(os.environ, COLUMNS=str(WIDTH)), contextlib.redirect_stdout(printed):
        main([*command.split(), "--help"])
    return printed.getvalue().strip()


if __name__ == "__main__":
    sys.stdout.write(reference())
