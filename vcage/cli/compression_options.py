"""Options of how videos are encoded and judged, for every command that compresses."""

from __future__ import annotations

import argparse
from dataclasses import fields

from vcage.cli.stages.common import number, positive
from vcage.datasets.packing.settings import AUTO, CompressionSettings
from vcage.video.choices import LOSSLESS
from vcage.video.encoders import CODECS

DEFAULTS = CompressionSettings()


def add_compression_options(parser: argparse.ArgumentParser) -> None:
    """Declare them; :func:`compression_settings` reads them."""
    group = parser.add_argument_group("encoding and judging")
    _add_judging(group)
    _add_encoding(group)


def _add_judging(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--max-loss",
        type=number(0, 10),
        default=DEFAULTS.max_loss,
        metavar="JOD",
        help="loss that no scored frame reaches (default: %(default)s)",
    )
    group.add_argument(
        "--reduce",
        choices=("max", "mean"),
        default=DEFAULTS.reduce,
        help="what of the scored frames' losses must stay below (default: %(default)s)",
    )
    group.add_argument(
        "--display",
        default=DEFAULTS.display,
        metavar="NAME",
        help="ColorVideoVDP's display model, which a loss depends on (default: %(default)s)",
    )
    group.add_argument(
        "--guard",
        action=argparse.BooleanOptionalAction,
        default=DEFAULTS.guard,
        help="score one in ten of the other frames too, and search again where they fail (default: on)",
    )
    group.add_argument(
        "--keyframes",
        type=positive,
        default=DEFAULTS.keyframes,
        metavar="N",
        help="frames that the search scores in each video (default: %(default)s)",
    )


def _add_encoding(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--scope",
        choices=("camera", "episode"),
        default=DEFAULTS.scope,
        help="one CRF for all episodes of a camera, as LeRobot can represent, or one for each (default: %(default)s)",
    )
    group.add_argument("--crf", type=crf_option, metavar="N", help="this CRF instead of a search; or 'lossless'")
    group.add_argument(
        "--codec", choices=tuple(CODECS), default=DEFAULTS.codec, help="video codec (default: %(default)s)"
    )
    group.add_argument("--preset", default="", metavar="NAME", help="the encoder's (default: the codec's usual one)")
    group.add_argument(
        "--pixel-format",
        default=AUTO,
        metavar="NAME",
        help="FFmpeg's name; auto tries those of the codec (default: %(default)s)",
    )
    group.add_argument(
        "--gop",
        type=_gop,
        default=DEFAULTS.gop,
        metavar="N",
        help="frames from one random-access point to the next; few make random frames quick to decode, auto tries "
        "several for the fewest bytes (default: %(default)s)",
    )


def compression_settings(args: argparse.Namespace) -> CompressionSettings:
    """The settings that were parsed.

    Raises:
        UsageError: they do not fit together.
    """
    return CompressionSettings(**{field.name: getattr(args, field.name) for field in fields(CompressionSettings)})


def crf_option(text: str) -> int:
    """A CRF, or "lossless", for ``type=`` of an option."""
    if text == "lossless":
        return LOSSLESS
    if text.isdecimal():
        return int(text)
    raise argparse.ArgumentTypeError(f"{text!r} is neither a CRF, a whole number from 0 on, nor 'lossless'")


def _gop(text: str) -> int | str:
    return text if text == AUTO else positive(text)
