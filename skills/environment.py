"""Lets a script run under any ``python3``: goes on in the project's environment, or says how to make it.

Every script runs this file first. Under the right interpreter it does nothing; under another it starts the same
script again with the right one, found in this order: ``$VCAGE_PYTHON``; ``.venv`` of ``$VCAGE_HOME``; ``.venv`` of
the checkout that this file lies in, or the environment that it is installed in; the one of ``vcage`` on the PATH.
Kept to syntax that Python 3.6 reads, since any interpreter may run it.
"""

import importlib.util
import json
import os
import shutil
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
RESTARTED = "VCAGE_RESTARTED"
NEEDED = ("vcage", "numpy", "pydantic", "sapien")


def candidates():
    """Interpreters that may be the project's, the most particular first; some do not exist."""
    if os.environ.get("VCAGE_PYTHON"):
        return [os.environ["VCAGE_PYTHON"]]
    root = os.path.dirname(HERE)
    found = [os.path.join(os.environ["VCAGE_HOME"], ".venv")] if os.environ.get("VCAGE_HOME") else []
    found.append(os.path.join(root, ".venv"))
    if os.path.basename(root) == "_data":  # <environment>/lib/python3.11/site-packages/vcage/_data
        found.append(os.path.abspath(os.path.join(root, *[os.pardir] * 5)))
    interpreters = [os.path.join(folder, "bin", "python") for folder in found]
    command = shutil.which("vcage")
    return interpreters + ([interpreter_of(command)] if command else [])


def interpreter_of(script):
    """The interpreter in a script's first line, or an empty text."""
    with open(script, "rb") as handle:
        line = handle.readline(512).decode("utf-8", "replace")
    words = line[2:].split() if line.startswith("#!") else []
    return words[0] if words and "python" in os.path.basename(words[0]) else ""


def is_running(interpreter):
    """Whether this process runs in the interpreter's environment (its links lead to the same system Python)."""
    prefix = os.path.dirname(os.path.dirname(os.path.abspath(interpreter)))
    return os.path.realpath(prefix) == os.path.realpath(sys.prefix)


def missing_modules():
    return [name for name in NEEDED if importlib.util.find_spec(name) is None]


def give_up(message, hint):
    """One line on stderr, one JSON line on stdout, exit code 4: configuration missing."""
    sys.stderr.write("vcage: error: {} ({})\n".format(message, hint))
    error = {"code": "configuration", "message": message, "hint": hint, "retryable": False, "details": {}}
    print(json.dumps({"ok": False, "error": error}))
    sys.exit(4)


def how_to_make():
    root = os.path.dirname(HERE)
    if os.path.exists(os.path.join(root, "Makefile")):
        return "run: make -C {} venv".format(root)
    return "install vcage with pip, or name its interpreter in VCAGE_PYTHON"


def ensure():
    """Return under the project's interpreter, or start the script again with it, or give up."""
    restarted = os.environ.pop(RESTARTED, "")
    existing = [path for path in candidates() if os.access(path, os.X_OK)]
    if os.environ.get("VCAGE_PYTHON") and not existing:
        give_up("VCAGE_PYTHON is not a program: " + os.environ["VCAGE_PYTHON"], "name a Python interpreter")
    if existing and not restarted and not is_running(existing[0]):
        # Search paths set for another interpreter would mix its packages with ours.
        kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
        kept[RESTARTED] = "1"
        sys.stdout.flush()
        # While this file runs, sys.argv[0] names this file, not the script.
        script = os.path.abspath(str(sys.modules["__main__"].__file__))
        os.execve(existing[0], [existing[0], script] + sys.argv[1:], kept)
    missing = missing_modules()
    if missing:
        give_up("no environment for vcage: {} cannot import {}".format(sys.executable, ", ".join(missing)), how_to_make())


ensure()
