"""Show the question that a stage would ask a model, without asking it."""

from __future__ import annotations

import shutil
from dataclasses import replace

from vcage.base.errors import UsageError
from vcage.base.files import PRODUCERS, RunFolder
from vcage.base.leftovers import scratch_folder
from vcage.models.exchange import Answerer, Question, Reply
from vcage.models.exchanges import Exchanges, Replayed, who_answered
from vcage.models.llm_critic import LlmCritic
from vcage.models.llm_editor import LlmEditor
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.protocols import Models
from vcage.models.registry import Choice, build_models, third_reader
from vcage.runs.context import StageContext
from vcage.runs.running import stage_of
from vcage.runs.stage import StageOptions
from vcage.stages import inpaint_plan

STAGE_OF_PROMPT = {
    "select_assets": "select_place",
    "search_catalogue": "select_place",
    "read_goals": "select_place",
    "review_goals": "select_place",
    "plan_layout": "inpaint_plan",
    "rearrange": "inpaint_plan",
    "judge_pairs": "search_subtasks",
    "fill_slots": "search_subtasks",
    "word_task": "search_subtasks",
    "judge_subtask": "verify",
}
"""Prompt → the stage that asks it (``collect`` asks the last one, too)."""

_READ = tuple(folder for folder in PRODUCERS if folder not in ("compress", "export"))
_HEAVY = ("*.hdf5", "*.mp4", "*.mkv")
"""Folders that stages read which ask, and files in them that these do not read."""


class _Asked(Exception):
    """Raised instead of asking the question."""

    def __init__(self, question: Question):
        super().__init__(question.name)
        self.question = question


class _Showing:
    """Implements :class:`vcage.models.exchange.Answerer`: stops at one prompt, and answers others from the record."""

    provider = "nobody"

    def __init__(self, name: str, kept: Answerer | None):
        self._name, self._kept = name, kept

    def answer(self, question: Question) -> Reply:
        if question.name == self._name or self._kept is None:
            raise _Asked(question)
        return self._kept.answer(question)


def question_of(name: str, run: RunFolder, options: StageOptions) -> Question:
    """Return the first question with a prompt that a stage would ask, its first round.

    Earlier questions of the stage are answered from the run's record, or by the rules that answered them.

    Args:
        name: of the prompt, one of :data:`STAGE_OF_PROMPT`.
        run: with the output of earlier stages; nothing in it is changed.
        options: of the stage.

    Raises:
        UsageError: the stage does not ask it here.
        VcageError: any error of the stage before its question, for one :class:`vcage.base.errors.MissingStage`.
    """
    stage = stage_of(STAGE_OF_PROMPT[name])
    if isinstance(options, inpaint_plan.Options):
        options = replace(options, target=None)  # a file anywhere, which no answer takes part in
    context = StageContext(Choice("offline"))
    context.__dict__["models"] = _models(name, run)
    stage.job(run, options, context).provenance()  # a missing input is named by its own path
    with scratch_folder() as folder:
        copy = RunFolder(folder / run.root.name)
        for name in _READ:
            if (run.root / name).is_dir():
                shutil.copytree(run.root / name, copy.root / name, ignore=shutil.ignore_patterns(*_HEAVY))
        output = stage.job(copy, options, context).output.parent
        shutil.rmtree(output, ignore_errors=True)
        try:
            stage.execute(copy, options, context, lambda *_: None)
        except _Asked as asked:
            return asked.question
    raise UsageError(f"{STAGE_OF_PROMPT[name]} does not ask {name} in {run}", hint="see its questions in the report")


def _models(name: str, run: RunFolder) -> Models:
    exchanges = Exchanges(run.exchanges)
    answered = who_answered(exchanges)
    kept = Replayed(exchanges, answered["reasoner"]) if "reasoner" in answered else None
    showing, rules = _Showing(name, kept), build_models(Choice("offline"))
    reasoner = LlmReasoner(showing, reviewer=showing, third=third_reader())
    if kept is None and hasattr(rules.reasoner, name):  # its prompts are called as its methods
        setattr(rules.reasoner, name, getattr(reasoner, name))
    return replace(
        rules,
        reasoner=rules.reasoner if kept is None else reasoner,
        editor=LlmEditor(showing) if name == "rearrange" else rules.editor,
        critic=LlmCritic(showing) if name == "judge_subtask" else rules.critic,
    )
