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
`{{"ok": false, "error": {{"code", "message", "hint", "retryable", "details"}}, "next"}}`; an error is also one line on
stderr. `next` is a command that goes on, quoted for a shell and with the options that were given before; it runs in any
folder. With `--progress json` each step of long work is a line of JSON on stdout before the last.

| exit code | meaning |
|---|---|
| 0 | done |
| 1 | a bug in vcage |
| 2 | the request cannot be met: usage, unknown name, no asset fits, no room, output not writable |
| 3 | an input file is missing, damaged, stale, or of another schema |
| 4 | a key, package or driver is missing |
| 5 | the model refused, finally; a policy raised an error, or answered what cannot be carried out |
| 6 | the endpoint failed for now, or another process works on the folder or writes a file; try again |
| 7 | partly done, a stage before was interrupted, or the disk is full; `next` goes on |
| 8 | with `--models agent`: an answer is needed, as `error.details.asked` says; `next` goes on |
| 9 | `replay`: what was recorded does not come about again; `error.details` says what differs |
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
