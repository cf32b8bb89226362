"""The choice of an implementation for each role.

``--models`` chooses reasoner, editor and critic by one word of :data:`CHOICES`; ``--reasoner``, ``--editor`` and
``--critic`` choose one of them alone. All but ``offline`` answer through :class:`vcage.models.exchanges.Stored`, so
each exchange is stored in the run. Detector and embedder always run on this machine and have names of their own, with
weights after a colon if there are several: ``background``, ``grounding-dino``,
``grounding-dino:IDEA-Research/grounding-dino-base``, ``dinov2:~/models/dinov2-large``. Records spell them likewise.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import get_args

from vcage.base.commands import vcage_command
from vcage.base.errors import ConfigurationError, InputFileError, UnknownName, UsageError
from vcage.base.files import RunFolder
from vcage.models import agent
from vcage.models.exchange import Answerer
from vcage.models.exchanges import Exchanges, Replayed, Stored, who_answered
from vcage.models.keys import require_key
from vcage.models.llm_critic import LlmCritic
from vcage.models.llm_editor import LlmEditor
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.protocols import OFFLINE, Models
from vcage.models.providers import PROVIDERS, automatic_choice, explain_automatic
from vcage.models.same_reading import ThirdReader
from vcage.models.shared import Shared, SharedAnswers
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
    """The choice of reasoner, editor and critic.

    Args:
        models: the choice for roles without one of their own; one of :data:`CHOICES`.
        reasoner, editor, critic: another choice for that role.
        run: folder of the run; it holds exchanges in ``exchanges/``, questions to an agent in ``ask/``.
        replayed: folder of the run whose exchanges ``replay`` reads; ``run`` by default.
        anew: ask answered questions again.
        fallback: :data:`OFFLINE` to let rules play a role whose endpoint does not serve its model; else an error.
        review: let a model review the reading of the instruction by a model.
        votes: how often the critic asks a model; see :class:`vcage.models.llm_critic.LlmCritic`.
        cap: limits on models online.
        shared: exchanges that many runs share, with limits of their own in place of ``cap``; None for a run by itself.
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
    shared: Shared | None = None

    def of(self, role: Asked) -> str:
        """The choice for a role: ``offline``, ``agent``, ``replay`` or a provider.

        Raises:
            UnknownName: there is no such choice.
            UsageError: a choice that does not draw is named as editor.
            ConfigurationError: a model without eyes is named as critic, or the key file cannot be read.
        """
        chosen = getattr(self, role) or self.models
        if chosen not in CHOICES:
            raise UnknownName(f"choice of the {role}", chosen, CHOICES)
        named = getattr(self, role) not in (None, "auto")
        chosen = automatic_choice() if chosen == "auto" else chosen
        if role == "editor" and not _draws(chosen):
            if named:
                hint = f"let {OFFLINE} be the --editor, or give a picture as --target of"
                raise UsageError(f"{chosen} does not draw", hint=hint, command=vcage_command("inpaint-plan", "--help"))
            return OFFLINE
        if role == "critic" and (blind := _blind(chosen)):
            if named and self.fallback is None:
                hint = f"name a model that does in {PROVIDERS[chosen].model_variable}, or let {OFFLINE} be the --critic"
                raise ConfigurationError(f"{blind}, and a critic must", hint=hint)
            return OFFLINE
        return chosen

    def announcement(self, roles: Sequence[Asked]) -> str:
        """The line about the choice of ``auto`` for these roles, and about rules in place of a critic without vision.

        Empty if neither is so.

        Raises:
            ConfigurationError: the key file cannot be read.
        """
        automatic = [role for role in roles if (getattr(self, role) or self.models) == "auto"]
        parts = [explain_automatic({role: self.of(role) for role in automatic})] if automatic else []
        if "critic" in roles and self.of("critic") == OFFLINE and (blind := _blind(self.critic or self.models)):
            parts.append(f"rules (offline) are the critic, since {blind}; --critic names another")
        return f"models: {'; '.join(parts)}" if parts else ""

    @property
    def exchanges(self) -> Exchanges:
        """The exchanges of this run.

        Raises:
            UsageError: there is no run.
        """
        return Exchanges(self._run().exchanges)

    def answerer(self, role: Asked) -> Answerer | None:
        """The answerer of the role's questions; None if rules answer.

        Raises:
            MissingKey: there is no key for the provider.
            ConfigurationError: money is limited, and the provider's price is not known.
            UsageError: there is no run for an agent's questions, or to replay.
            InputFileError: the run to replay holds no exchange.
        """
        chosen = self.of(role)
        if chosen == OFFLINE:
            return None
        if chosen == "replay":
            return self._replayed(role)
        if chosen == agent.PROVIDER:
            # The agent stores its answers itself, beside the questions.
            return Stored(agent.Agent(self._run().questions), self.exchanges, anew=True)
        provider = PROVIDERS[chosen]
        client = provider.connect(require_key(provider), picture=role == "editor")
        if self.fallback is not None and (reason := client.not_served()):
            logger.warning("%s: rules (offline) play the %s", reason.message, role)
            return None
        if self.run is None:
            return client
        if self.shared is not None:
            paid, reports = provider.needs_key, provider.reports_cost
            return Stored(SharedAnswers(client, self.shared, paid=paid, reports_cost=reports), self.exchanges)
        spending = None
        if provider.needs_key:
            folder = self.exchanges.folder
            spending = Spending(folder, self.cap, client.provider, reports_cost=provider.reports_cost)
        return Stored(client, self.exchanges, anew=self.anew, spending=spending)

    def _replayed(self, role: Asked) -> Replayed | None:
        """The stored answers of the role; None for rules, which give the same answers each time."""
        exchanges = self.exchanges if self.replayed is None else Exchanges(RunFolder(self.replayed).exchanges)
        answered = who_answered(exchanges)
        if not answered:
            raise InputFileError(
                f"{exchanges.folder} holds no exchange to replay",
                hint="name a run that asked models: --replay RUN; for a run with rules, use --models offline",
            )
        return Replayed(exchanges, answered[role]) if role in answered else None

    def _run(self) -> RunFolder:
        if self.run is None:
            raise UsageError("there is no run folder for the exchanges", hint="give one with --run")
        return RunFolder(self.run)


def _draws(chosen: str) -> bool:
    return PROVIDERS[chosen].picture is not None if chosen in PROVIDERS else chosen != agent.PROVIDER


def _blind(chosen: str) -> str:
    """The sentence that the choice sees no pictures; empty if it does."""
    return PROVIDERS[chosen].blind() if chosen in PROVIDERS else ""


def build_models(choice: Choice, detector: str = DETECTORS[0], embedder: str = EMBEDDERS[0]) -> Models:
    """Build the implementations of all roles.

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
    from vcage.models.rules.critic import OfflineCritic
    from vcage.models.rules.editor import OfflineEditor
    from vcage.models.rules.reasoner import OfflineReasoner

    found = build_detector(*split_weights(detector)), build_embedder(*split_weights(embedder))
    thinks, draws, judges = map(choice.answerer, get_args(Asked))
    reviewer = thinks if choice.review else None
    reasoner = LlmReasoner(thinks, reviewer=reviewer, third=third_reader()) if thinks else OfflineReasoner()
    editor = LlmEditor(draws) if draws else OfflineEditor()
    return Models(reasoner, editor, *found, LlmCritic(judges, choice.votes) if judges else OfflineCritic())


def third_reader() -> ThirdReader:
    """The reader without a model; readings of others are compared with its own."""
    from vcage.models.rules.reasoner import OfflineReasoner

    return OfflineReasoner().read_goals


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
