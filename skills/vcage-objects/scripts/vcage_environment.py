"""Let a script of a skill run under any ``python3``, wherever the skill was put.

It goes on in the project's environment, the first that exists of: ``$VCAGE_PYTHON``; ``.venv`` of ``$VCAGE_HOME``;
``.venv`` of the checkout that this file lies in (also by a link), or the environment that it is installed in; the one
of ``vcage`` on the PATH or in ``~/.local/bin``. Without one it says how to get it.

Each skill may be installed alone, so `make skills` copies skills/vcage_environment.py into all of them: edit that one.
It keeps to the syntax of Python 3.6, since any interpreter may run it.
"""

import importlib.util
import json
import os
import shlex
import shutil
import sys

ROOT = os.path.abspath(os.path.join(os.path.realpath(__file__), *[os.pardir] * 4))
RESTARTED = "VCAGE_RESTARTED"
NEEDED = ("vcage", "numpy", "pydantic", "sapien")


def candidates():
    """Return interpreters that may be the project's, the most particular first; some do not exist."""
    if os.environ.get("VCAGE_PYTHON"):
        return [os.environ["VCAGE_PYTHON"]]
    found = [os.path.join(os.environ["VCAGE_HOME"], ".venv")] if os.environ.get("VCAGE_HOME") else []
    found.append(os.path.join(ROOT, ".venv"))
    if os.path.basename(ROOT) == "_data":  # <environment>/lib/python3.11/site-packages/vcage/_data
        found.append(os.path.abspath(os.path.join(ROOT, *[os.pardir] * 5)))
    interpreters = [os.path.join(folder, "bin", "python") for folder in found]
    command = shutil.which("vcage") or shutil.which("vcage", path=os.path.expanduser("~/.local/bin"))
    return interpreters + ([interpreter_of(command)] if command else [])


def interpreter_of(script):
    """Return the interpreter in a script's first line, or an empty text."""
    with open(script, "rb") as handle:
        line = handle.readline(512).decode("utf-8", "replace")
    words = line[2:].split() if line.startswith("#!") else []
    return words[0] if words and "python" in os.path.basename(words[0]) else ""


def is_running(interpreter):
    """True if this process runs in the interpreter's environment (its links lead to the same system Python)."""
    prefix = os.path.dirname(os.path.dirname(os.path.abspath(interpreter)))
    return os.path.realpath(prefix) == os.path.realpath(sys.prefix)


def give_up(message):
    """Say what is missing in one line on stderr and one of JSON on stdout, and end with exit code 4."""
    command = None
    hint = "get the project, run `make setup` in its folder and name that in VCAGE_HOME, or put its vcage on the PATH"
    home = os.environ.get("VCAGE_HOME") or ROOT
    if os.environ.get("VCAGE_PYTHON"):
        hint = "name the project's Python in VCAGE_PYTHON, or leave that out"
    elif os.path.exists(os.path.join(home, "Makefile")) and os.path.exists(os.path.join(home, "vcage")):
        command = "make -C {} setup".format(shlex.quote(os.path.abspath(home)))
        hint = "make its environment: " + command
    error = {"code": "configuration", "message": message, "hint": hint, "retryable": False, "details": {}}
    write(sys.stderr, "vcage: error: {}; {}\n".format(message, hint))
    write(sys.stdout, json.dumps({"ok": False, "error": error, "next": command}) + "\n")
    os._exit(4)


def write(stream, text):
    """Write to a stream, unless it is closed or takes nothing."""
    try:
        stream.write(text)
        stream.flush()
    except (AttributeError, OSError):
        pass


def main(command):
    """Run a command of ``vcage`` under the project's interpreter."""
    restarted = os.environ.pop(RESTARTED, "")
    existing = [path for path in candidates() if os.access(path, os.X_OK)]
    if os.environ.get("VCAGE_PYTHON") and not existing:
        give_up("VCAGE_PYTHON is not a program: " + os.environ["VCAGE_PYTHON"])
    if existing and not restarted and not is_running(existing[0]):
        # Search paths set for another interpreter would mix its packages with ours.
        kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
        kept[RESTARTED] = "1"
        os.execve(existing[0], [existing[0], os.path.abspath(sys.argv[0])] + sys.argv[1:], kept)
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        give_up("no environment for vcage: {} cannot import {}".format(sys.executable, ", ".join(missing)))
    from vcage.cli.main import script_main

    sys.exit(script_main(command))
