"""Parametric objects: the ``model.py`` beside an annotation is imported by its path on first use.

It defines ``build(variant: str) -> BuiltObject``, made with ``vcage.objects.modelling``. What several objects are made
from it imports from ``assets.shapes`` and ``assets.textures``, where ``assets`` is the folder of the project's data,
wherever that lies: in a checkout or in an installed package.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import hashlib
import importlib.machinery
import importlib.util
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

from vcage.base.errors import InputFileError
from vcage.base.files import resource
from vcage.objects.modelling.parts import BuiltObject

MODEL = "model.py"
"""Beside ``asset.json``."""

Builder = Callable[[str], BuiltObject]
"""From the id of a variant to its geometry; raises ``KeyError(variant)`` when there is no such variant."""


def build(folder: Path, variant: str) -> BuiltObject:
    """Build a variant of the object in a folder.

    Raises:
        InputFileError: there is no ``model.py``, it cannot be imported, it fails, or it knows no such variant.
    """
    path = folder / MODEL
    builder = _builder(path)
    try:
        built = builder(variant)
    except Exception as error:  # whatever the code of an object does wrong
        if isinstance(error, KeyError) and error.args == (variant,):
            raise InputFileError(
                f"the builder of asset {folder.name!r} knows no variant {variant!r}",
                hint=f"fix the variants in {folder / 'asset.json'}, or {path}",
                details={"name": folder.name, "path": str(path), "variant": variant},
            ) from error
        what = f"build({variant!r}) failed{_place(error, path)}: {type(error).__name__}: {error}"
        raise _wrong(path, what) from error
    if not isinstance(built, BuiltObject):
        raise _wrong(path, f"build({variant!r}) returned a {type(built).__name__}; expected a BuiltObject")
    return built


@functools.cache
def _builder(path: Path) -> Builder:
    """The function ``build`` of a ``model.py``."""
    name = path.parent.name
    if not path.is_file():
        raise InputFileError(
            f"asset {name!r} has an annotation but no builder: there is no {path}",
            hint=f"write it ({resource('docs', 'assets.md')} shows how), or remove the annotation",
            details={"name": name, "path": str(path)},
        )
    try:
        module = _imported(f"assets.objects.{name}.model", path)
    except Exception as error:  # whatever the code of an object does wrong
        raise _wrong(path, f"it cannot be imported: {type(error).__name__}: {error}") from error
    found = getattr(module, "build", None)
    if not callable(found):
        raise _wrong(path, "there is no function build; expected build(variant: str) -> BuiltObject")
    return found


def _place(error: Exception, path: Path) -> str:
    """The innermost line of a file that an error passed, in words; nothing where it passed none."""
    lines = [at.lineno for at in traceback.extract_tb(error.__traceback__) if at.filename == str(path)]
    return f" in line {lines[-1]}" if lines else ""


def _wrong(path: Path, what: str) -> InputFileError:
    return InputFileError(
        f"{path}: {what}", hint=f"fix it; {resource('docs', 'assets.md')} shows how", details={"path": str(path)}
    )


# --- importing ---------------------------------------------------------------------------------------------

_lock = threading.Lock()

_modules: dict[str, ModuleType] = {}
"""The package ``assets`` and what was imported from it.

It is in ``sys.modules`` only while a ``model.py`` is imported: a program may have an ``assets`` of its own.
"""


def _imported(name: str, path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"no loader for {path}")
    module = importlib.util.module_from_spec(spec)
    with _our_assets():
        sys.modules[name] = module  # where dataclasses resolve their annotations
        try:
            spec.loader.exec_module(module)
        finally:
            del sys.modules[name]
    return module


@contextlib.contextmanager
def _our_assets() -> Iterator[None]:
    """Let ``import assets.shapes.…`` find the project's data, and restore ``sys.modules`` afterwards."""
    with _lock:
        if not _modules:
            spec = importlib.machinery.ModuleSpec("assets", None, is_package=True)
            spec.submodule_search_locations = [str(resource("assets"))]
            _modules["assets"] = importlib.util.module_from_spec(spec)
        others = _taken_out()
        sys.modules.update(_modules)
        try:
            yield
        finally:
            _modules.update(_taken_out())
            sys.modules.update(others)


def _taken_out() -> dict[str, ModuleType]:
    names = [name for name in sys.modules if name == "assets" or name.startswith("assets.")]
    return {name: sys.modules.pop(name) for name in names}


# --- what decides the result -------------------------------------------------------------------------------


@functools.cache
def sources_hash(folder: Path) -> str:
    """Hash of the sources that affect the model: ``model.py``, and its imported shapes and helpers."""
    digest = hashlib.sha256()
    found: dict[str, Path] = {}
    new = {MODEL: folder / MODEL, "vcage.objects.model": Path(__file__).with_name("model.py")}
    while new:
        found |= new
        new = {name: path for old in new.values() for name, path in _imports(old).items() if name not in found}
    for name, path in sorted(found.items()):
        digest.update(name.encode() + b"\0" + (path.read_bytes() if path.is_file() else b""))
    return digest.hexdigest()


@functools.cache
def _imports(path: Path) -> dict[str, Path]:
    """The modules of ``assets`` and of the modelling helpers that a module names, by their full names."""
    try:
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError):  # building it reports the error
        return {}
    names = set()
    for node in _statements(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    roots = {"assets.": resource("assets"), "vcage.objects.modelling.": Path(__file__).with_name("modelling")}
    files = {
        name: folder.joinpath(*name.removeprefix(package).split(".")).with_suffix(".py")
        for package, folder in roots.items()
        for name in names
        if name.startswith(package)
    }
    return {name: path for name, path in files.items() if path.is_file()}


def _statements(tree: ast.AST) -> Iterator[ast.AST]:
    """All statements of a module, however deep; most of a tree are expressions, and hold none."""
    for node in ast.iter_child_nodes(tree):
        if not isinstance(node, ast.expr):
            yield node
            yield from _statements(node)
