"""Which implementation plays which role.

``--models`` chooses reasoner, editor and critic by one word of :data:`CHOICES`, and
``--reasoner``, ``--editor`` and ``--critic`` one of them alone. What answers questions in words and pictures (all but
``offline``) is asked through :class:`vcage.models.kept.Keeping`, so every exchange is kept under the run. Detector and
embedder run on this machine in every choice, and are chosen by a name of their own, with weights after a colon where
it has a choice of them: ``background``, ``grounding-dino``, ``grounding-dino:IDEA-Research/grounding-dino-base``,
``dinov2:~/models/dinov2-large``. That is how they are spelled in a record's provenance, too.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from vcage.base.commands import vcage_command
from vcage.base.errors import ConfigurationError, InputFileError, UnknownName, UsageError
from vcage.base.files import RunFolder
from vcage.models import agent
from vcage.models.exchange import Answerer
from vcage.models.kept import Exchanges, Keeping, Replayed, who_answered
from vcage.models.keys import require_key, variables
from vcage.models.llm_critic import LlmCritic
from vcage.models.llm_editor import LlmEditor
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.ollama import OLLAMA
from vcage.models.protocols import OFFLINE, Critic, ImageEditor, Models, Reasoner
from vcage.models.providers import PROVIDERS, found_keys
from vcage.models.same_reading import ThirdReader
from vcage.models.spending import Cap, Spending
from vcage.schema.exchange import Asked
from vcage.vision.protocols import Detector, Embedder

logger = logging.getLogger(__name__)

CHOICES = ("auto", OFFLINE, agent.PROVIDER, "replay", *PROVIDERS)

DETECTORS = ("background", "grounding-dino")
EMBEDDERS = ("classical", "efficientnet", "dinov2")
"""The first of each needs no weights and is the default."""


@dataclass(frozen=True)
class Choice:
    """Who plays reasoner, editor and critic.

    Args:
        models: who does where no other is named; one of :data:`CHOICES`.
        reasoner, editor, critic: another one for that role.
        run: folder of the run: exchanges are kept in its ``exchanges/``, questions to an agent lie in its ``ask/``.
        replayed: folder of the run whose exchanges ``replay`` reads; ``run`` when left out.
        anew: ask again what was answered before.
        fallback: :data:`OFFLINE`, if rules play a role whose endpoint does not serve its model; else that is an error.
        review: whether a model looks at what a model read in the instruction.
        votes: how often the critic asks a model; see :class:`vcage.models.llm_critic.LlmCritic`.
        cap: what the run may spend on models online.
    """

    models: str = "auto"
    reasoner: str | None = None
    editor: str | None = None
    critic: str | None = None
    run: Path | None = None
    replayed: Path | None = None
    anew: bool = False
    fallback: str | None = None
    review: bool = True
    votes: int = 1
    cap: Cap = field(default_factory=Cap)

    def of(self, role: Asked) -> str:
        """Who plays a role: ``offline``, ``agent``, ``replay`` or a provider.

        Raises:
            UnknownName: there is no such choice.
            UsageError: who does not draw is named as editor.
        ConfigurationError: who does not see is named as critic, or the key file cannot be read.
        """
        chosen = getattr(self, role) or self.models
        if chosen not in CHOICES:
            raise UnknownName(f"choice of the {role}", chosen, CHOICES)
        named = getattr(self, role) not in (None, "auto")
        if chosen == "auto":
            chosen = _taken()
        if role == "editor" and (chosen == agent.PROVIDER or (chosen in PROVIDERS and not PROVIDERS[chosen].picture)):
            if not named:
                return OFFLINE
            hint = f"let {OFFLINE} be the --editor, or give a picture as --target of"
            raise UsageError(f"{chosen} does not draw", hint=hint, command=vcage_command("inpaint-plan", "--help"))
        if role == "critic" and (blind := _blind(chosen)):
            if not named or self.fallback is not None:
                return OFFLINE
            hint = f"name a model that does in {PROVIDERS[chosen].model_variable}, or let {OFFLINE} be the --critic"
            raise ConfigurationError(f"{blind}, and a critic must", hint=hint)
        return chosen

    def told(self, roles: Sequence[Asked]) -> str:
        """Say what ``auto`` takes for these roles, and why; and that rules are the critic for a blind model.

        Empty where neither is so.

        Raises:
            ConfigurationError: the key file cannot be read.
        """
        chosen = {role: getattr(self, role) or self.models for role in roles}
        left = [role for role in roles if chosen[role] == "auto"]
        parts = []
        if left and (mine := [role for role in left if self.of(role) != OFFLINE]):
            others = [role for role in left if role not in mine]
            rest = f", rules (offline) for {', '.join(others)}" if others else ""
            parts = [f"{_taken()} for {', '.join(mine)}{rest}, {_why(_taken())}; --models names another"]
        elif left:
            parts = [f"rules (offline) for {', '.join(left)}, {_why(_taken())}"]
        if "critic" in roles and self.of("critic") == OFFLINE and (blind := _blind(chosen["critic"])):
            parts.append(f"rules (offline) are the critic, since {blind}; --critic names another")
        return f"models: {'; '.join(parts)}" if parts else ""

    @property
    def exchanges(self) -> Exchanges:
        """Of this run, or of the one that is replayed.

        Raises:
            UsageError: there is no run.
        """
        return Exchanges(self._run().exchanges)

    def answerer(self, role: Asked) -> Answerer | None:
        """Who answers the role's questions; None where rules do.

        Raises:
            MissingKey: the provider's key is nowhere to be found.
            ConfigurationError: money is capped, and what the provider takes is not known.
            UsageError: there is no run in which an agent could be asked, or to replay.
            InputFileError: what is to be replayed holds no exchange.
        """
        chosen = self.of(role)
        if chosen == OFFLINE:
            return None
        if chosen == "replay":
            return self._replayed(role)
        if chosen == agent.PROVIDER:
            # It keeps its answers itself, beside the questions.
            return Keeping(agent.Agent(self._run().questions), self.exchanges, anew=True)
        provider = PROVIDERS[chosen]
        who = provider.connect(require_key(provider), picture=role == "editor")
        if self.fallback is not None and (reason := who.not_served()):
            logger.warning("%s: rules (offline) play the %s", reason.message, role)
            return None
        if self.run is None:
            return who
        paid = provider.needs_key
        spending = Spending(self.exchanges.folder, self.cap, who.provider, tells=provider.tells_cost) if paid else None
        return Keeping(who, self.exchanges, anew=self.anew, spending=spending)

    def _replayed(self, role: Asked) -> Replayed | None:
        """What was answered in the role; None where nobody was asked, as rules answer alike each time."""
        exchanges = self.exchanges if self.replayed is None else Exchanges(RunFolder(self.replayed).exchanges)
        answered = who_answered(exchanges)
        if not answered:
            raise InputFileError(
                f"{exchanges.folder} holds no exchange to replay",
                hint="name the run that asked models: --replay RUN; where rules answered, take --models offline",
            )
        return Replayed(exchanges, answered[role]) if role in answered else None

    def _run(self) -> RunFolder:
        if self.run is None:
            raise UsageError("there is no run folder to keep exchanges in", hint="give one with --run")
        return RunFolder(self.run)


def _taken() -> str:
    """The choice of ``auto``."""
    return next(iter(found_keys()), OLLAMA.name if OLLAMA.is_there() else OFFLINE)


def _why(taken: str) -> str:
    """Say why ``auto`` takes that."""
    found = found_keys()
    if taken in found:
        others = f"; {' and '.join(rest)} too" if (rest := [other for other in found if other != taken]) else ""
        return f"since its key is in {found[taken]}{others}"
    if taken == OLLAMA.name:
        return f"since no provider has a key and it answers at {OLLAMA.url} with {OLLAMA.found().model}"
    names = ", ".join(variables(provider)[0] for provider in PROVIDERS.values() if provider.needs_key)
    return f"since there is no key of a provider in {names}, and no Ollama at {OLLAMA.url}"


def _blind(chosen: str) -> str:
    """Say that who was chosen sees no pictures; empty where it does."""
    return PROVIDERS[chosen].blind() if chosen in PROVIDERS else ""


def build_models(choice: Choice, detector: str = DETECTORS[0], embedder: str = EMBEDDERS[0]) -> Models:
    """All roles.

    Base URLs and model ids come from ``VCAGE_<PROVIDER>_BASE_URL``, ``…_TEXT_MODEL`` and ``…_IMAGE_MODEL``
    where these are set.

    Args:
        choice: who plays reasoner, editor and critic.
        detector, embedder: a name of :data:`DETECTORS`, :data:`EMBEDDERS`; ``name:weights`` for other weights.

    Raises:
        UnknownName: there is no such choice, detector or embedder.
        MissingKey, UsageError, InputFileError: see :meth:`Choice.answerer`.
        MissingDependency, InputFileError: see :func:`build_detector`.
    """
    found = build_detector(*split_weights(detector)), build_embedder(*split_weights(embedder))
    return Models(_reasoner(choice), _editor(choice), *found, _critic(choice))


def _reasoner(choice: Choice) -> Reasoner:
    from vcage.models.rules.reasoner import OfflineReasoner

    if who := choice.answerer("reasoner"):
        return LlmReasoner(who, reviewer=who if choice.review else None, third=third_reader())
    return OfflineReasoner()


def third_reader() -> ThirdReader:
    """The reader without a model, with which readings by others are compared."""
    from vcage.models.rules.reasoner import OfflineReasoner

    return OfflineReasoner().read_goals


def _editor(choice: Choice) -> ImageEditor:
    if who := choice.answerer("editor"):
        return LlmEditor(who)
    from vcage.models.rules.editor import OfflineEditor

    return OfflineEditor()


def _critic(choice: Choice) -> Critic:
    if who := choice.answerer("critic"):
        return LlmCritic(who, choice.votes)
    from vcage.models.rules.critic import OfflineCritic

    return OfflineCritic()


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
