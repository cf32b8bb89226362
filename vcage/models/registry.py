"""Which implementation plays which role.

``--models auto|offline|gemini|openai|openrouter`` chooses reasoner, editor and critic by one word. Detector and
embedder run on this machine in every choice, and are chosen by a name of their own, with weights after a colon where
it has a choice of them: ``background``, ``grounding-dino``, ``grounding-dino:IDEA-Research/grounding-dino-base``,
``dinov2:~/models/dinov2-large``. That is how they are spelled in a record's provenance, too.
"""

from __future__ import annotations

from vcage.base.errors import UnknownName, UsageError
from vcage.models.gemini import GEMINI
from vcage.models.keys import find_key, require_key
from vcage.models.llm_critic import LlmCritic
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.openai import OPENAI
from vcage.models.openrouter import OPENROUTER
from vcage.models.protocols import Models
from vcage.models.provider import Provider
from vcage.vision.protocols import Detector, Embedder

PROVIDERS: dict[str, Provider] = {provider.name: provider for provider in (GEMINI, OPENAI, OPENROUTER)}
"""Online choices, in the order in which ``auto`` takes the first one that has a key."""

CHOICES = ("auto", "offline", *PROVIDERS)

DETECTORS = ("background", "grounding-dino")
EMBEDDERS = ("classical", "efficientnet", "dinov2")
"""The first of each needs no weights and is the default."""


def found_keys() -> dict[str, str]:
    """Provider → the name of the variable or file that holds its key, for those that have one; never the key.

    Raises:
        ConfigurationError: the key file cannot be read.
    """
    return {name: found[1] for name, provider in PROVIDERS.items() if (found := find_key(provider)) is not None}


def build_models(choice: str = "auto", detector: str = DETECTORS[0], embedder: str = EMBEDDERS[0]) -> Models:
    """All roles.

    Base URLs and model ids come from ``VCAGE_<PROVIDER>_BASE_URL``, ``…_TEXT_MODEL`` and ``…_IMAGE_MODEL``
    where these are set.

    Args:
        choice: who plays reasoner, editor and critic.
        detector, embedder: a name of :data:`DETECTORS`, :data:`EMBEDDERS`; ``name:weights`` for other weights.

    Raises:
        UnknownName: there is no such choice, detector or embedder.
        MissingKey: the provider's key is nowhere to be found.
        MissingDependency, InputFileError: see :func:`build_detector`.
    """
    if choice not in CHOICES:
        raise UnknownName("choice of models", choice, CHOICES)
    found = build_detector(*split_weights(detector)), build_embedder(*split_weights(embedder))
    if choice == "auto":
        choice = next(iter(found_keys()), "offline")
    if choice == "offline":
        from vcage.models.rules.critic import OfflineCritic
        from vcage.models.rules.editor import OfflineEditor
        from vcage.models.rules.reasoner import OfflineReasoner

        return Models(OfflineReasoner(), OfflineEditor(), *found, OfflineCritic())
    provider = PROVIDERS[choice]
    chat, editor = provider.connect(require_key(provider))
    return Models(LlmReasoner(chat), editor, *found, LlmCritic(chat))


def split_weights(spelled: str) -> tuple[str, str | None]:
    """``name:weights`` as (name, weights), a name alone as (name, None)."""
    name, _, weights = spelled.partition(":")
    return name, weights or None


def build_detector(name: str, weights: str | None = None) -> Detector:
    """The detector of that name; weights are read when it first looks at a picture.

    Args:
        weights: a hub id or a folder, for a detector that has a choice of them.

    Raises:
        UnknownName: there is no such detector.
        UsageError: it takes no weights.
        MissingDependency: a package that it needs is not installed.
        InputFileError: the weights are neither a hub id nor there.
    """
    if name == "grounding-dino":
        from vcage.vision.networks.grounding_dino import GroundingDinoDetector

        return GroundingDinoDetector(weights)
    if name not in DETECTORS:
        raise UnknownName("detector", name, DETECTORS)
    _no_weights("detector", name, weights)
    from vcage.vision.detector import BackgroundDetector

    return BackgroundDetector()


def build_embedder(name: str, weights: str | None = None) -> Embedder:
    """The embedder of that name; see :func:`build_detector`. ``efficientnet`` takes a file of parameters."""
    if name == "efficientnet":
        from vcage.vision.networks.efficientnet import EfficientNetEmbedder

        return EfficientNetEmbedder(weights)
    if name == "dinov2":
        from vcage.vision.networks.dinov2 import Dinov2Embedder

        return Dinov2Embedder(weights)
    if name not in EMBEDDERS:
        raise UnknownName("embedder", name, EMBEDDERS)
    _no_weights("embedder", name, weights)
    from vcage.vision.embedder import ClassicalEmbedder

    return ClassicalEmbedder()


def _no_weights(role: str, name: str, weights: str | None) -> None:
    if weights is not None:
        raise UsageError(f"the {role} {name} has no weights to choose", hint=f"give it as: {name}")
