"""The ways in which lerobot decodes video, made to work beside a build of torch that they were not made for."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import torch

SIGNATURE_OF_NMS = "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"


def prepare_torchvision() -> None:
    """Let torchvision be imported, to be called before anything imports it.

    Its compiled operators fit one version of torch, built for CUDA; beside another its import fails, for it describes
    an operator that is not there. Nothing that lerobot takes from torchvision to read video is compiled.
    """
    spec = importlib.util.find_spec("torchvision")
    assert spec is not None and spec.origin is not None, "torchvision is not installed"
    try:
        torch.ops.load_library(Path(spec.origin).with_name("_C.so"))
    except OSError:
        torch.library.define("torchvision::nms", SIGNATURE_OF_NMS)


def backends() -> tuple[list[str], dict[str, str]]:
    """Names of the ways that work here, and why the others do not.

    torchcodec, lerobot's default, needs the shared libraries of FFmpeg and of Python.
    """
    try:
        import torchcodec  # noqa: F401
    except (RuntimeError, ImportError, OSError) as error:
        return ["pyav"], {"torchcodec": str(error).strip().splitlines()[0]}
    return ["pyav", "torchcodec"], {}
