"""Prompts are files, ``prompts/<name>.md``, with named placeholders ``{{ name }}``."""

from __future__ import annotations

import functools
from typing import NamedTuple

import jinja2
import jinja2.meta

from vcage.base.errors import ConfigurationError, UnknownName
from vcage.base.files import resource
from vcage.base.reading import Unreadable, text_of
from vcage.base.text import one_line


def names() -> list[str]:
    """The names of all prompts."""
    return sorted(path.stem for path in resource("prompts").glob("*.md"))


class Prompt(NamedTuple):
    """A prompt as it is sent.

    Args:
        name: of its file, without ``.md``.
        text: with all placeholders filled in.
    """

    name: str
    text: str


def fill(name: str, **values: object) -> Prompt:
    """The prompt with all its placeholders filled in.

    Raises:
        UnknownName: there is no such prompt.
        ConfigurationError: the prompt's placeholders are not exactly the values that the engine gives.
    """
    path = resource("prompts", f"{name}.md")
    if not path.is_file():
        raise UnknownName("prompt", name, names())
    try:
        template, wanted = _compiled(text_of(path.read_bytes()))
    except Unreadable as error:
        raise ConfigurationError(f"{path}, {error}", hint="fix the prompt") from error
    except jinja2.TemplateSyntaxError as error:
        raise ConfigurationError(f"{path}, line {error.lineno}: {error.message}", hint="fix the prompt") from error
    if wanted != set(values):
        raise ConfigurationError(
            f"{path} uses the placeholders {sorted(wanted)}, but gets {sorted(values)}",
            hint="name exactly these in the prompt",
        )
    return Prompt(name, template.render(**values).strip())


@functools.lru_cache(maxsize=64)
def _compiled(text: str) -> tuple[jinja2.Template, frozenset[str]]:
    """A prompt's template and its placeholders; kept, because compiling takes longer than filling."""
    environment = jinja2.Environment(
        undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True, finalize=_value
    )
    return environment.from_string(text), frozenset(jinja2.meta.find_undeclared_variables(environment.parse(text)))


def _value(value: object) -> object:
    """Return the text for a placeholder on one line: words of an object or an instruction never begin a line."""
    return one_line(value) if isinstance(value, str) else value
