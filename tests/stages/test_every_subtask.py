"""A scene without an instruction: its template names the objects, and every sub-task of it is a chain."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from typing import Any

import pytest
import yaml

from tests.run_folders import OPTIONS, command
from vcage.base.errors import UsageError
from vcage.base.files import RunFolder, data_path, resource
from vcage.episodes.quota import RUNS_PER_EPISODE, Wanted
from vcage.runs.context import StageContext
from vcage.schema.episodes import Episode, Episodes
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import select_place
from vcage.stages.chain import run_chain

pytestmark = pytest.mark.slow

CONTENTS = [{"assets": ["plate"], "role": "receptacle"}, {"assets": ["apple", "orange"], "count": 2}]


@pytest.fixture(scope="module")
def finished_scene(nothing_imported: None, tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """Every sub-task of a scene of the user's own: fruit beside a plate, through all stages."""
    template = yaml.safe_load(resource("assets", "scenes", "table.yml").read_text())
    path = data_path("scenes") / "snack.yml"
    path.parent.mkdir(parents=True)
    path.write_text(yaml.safe_dump({**template, "name": "snack", "contents": CONTENTS}))
    run = RunFolder(tmp_path_factory.mktemp("snack") / "run")
    run_chain(run, replace(OPTIONS, instruction=None, template="snack", all_subtasks=True, episodes=None))
    return run


def test_the_objects_come_from_the_template(finished_scene):
    for scene in (Scene.read(finished_scene.scene), Scene.read(finished_scene.layout)):
        assert (scene.instruction, scene.goals) == (None, [])
        assert {o.asset: o.role for o in scene.objects} == {
            "plate": "receptacle",
            "apple": "content",
            "orange": "content",
        }
    assert Plan.read(finished_scene.plan).instruction is None


def test_every_sub_task_is_a_chain_of_its_own_and_called_by_its_words(finished_scene):
    record = Subtasks.read(finished_scene.subtasks)
    assert [chain.subtasks for chain in record.chains] == [[subtask.id] for subtask in record.kept]
    assert [chain.text for chain in record.chains] == [subtask.text for subtask in record.kept]
    assert {subtask.object.split("_")[0] for subtask in record.kept} == {"apple", "orange"}


def test_each_has_a_verified_episode(finished_scene):
    record, subtasks = Episodes.read(finished_scene.episodes), Subtasks.read(finished_scene.subtasks)
    verified = [episode for episode in record.episodes if episode.accepted]
    assert sorted(episode.chain for episode in verified) == list(range(len(subtasks.chains)))
    assert all(episode.subtasks == subtasks.chains[episode.chain].subtasks for episode in verified)


def test_the_same_command_again_does_nothing(finished_scene, capsys):
    line = ["run", "--scene", "snack", "--all-subtasks", "--out", finished_scene.root, "--models", "offline"]
    answer = command(
        capsys, *line, "--fps", "5", "--workers", "1", "--crf", "20", "--effort", "fast", "--keyframes", "2"
    )
    assert answer.code == 0, answer.stderr


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"instruction": None}, "there is no instruction"),
        ({"all_subtasks": True}, "takes no instruction"),
        ({"instruction": None, "all_subtasks": True, "template": "table"}, "the scene table has no contents"),
        ({"randomise": "full", "layout": "fixed"}, "full asks for other variants"),
        ({"randomise": "lava"}, "unknown randomisation 'lava'"),
    ],
)
def test_either_an_instruction_or_every_sub_task_of_a_scene_with_contents(changes, complaint, tmp_path):
    with pytest.raises(UsageError, match=complaint):
        run_chain(RunFolder(tmp_path / "run"), replace(OPTIONS, **changes))
    assert not (tmp_path / "run" / "place").exists()


def test_a_draw_of_a_scene_of_ours_depends_on_the_seed_alone(tmp_path):
    context, number = StageContext("offline"), count()

    def drawn(seed: int) -> list[Any]:
        run = RunFolder(tmp_path / str(next(number)))
        select_place.execute(run, select_place.Options(template="cabinet", models="offline", seed=seed), context)
        return [(o.asset, o.variant, o.pose) for o in Scene.read(run.scene).objects]

    assert drawn(0) == drawn(0) != drawn(1)


# --- which episodes are run ----------------------------------------------------------------------------


def ran(chain: int, accepted: bool) -> Episode:
    return Episode.model_construct(chain=chain, accepted=accepted)


@pytest.fixture
def wanted() -> Iterator[Any]:
    return Wanted(chains=3, each=2)


def test_episodes_are_shared_out_over_the_chains(wanted):
    assert wanted.next([], []) == [0, 1, 2, 3, 4, 5]
    assert wanted.next([ran(0, True), ran(1, False)], [2, 5]) == [3, 4, 7]


def test_failures_are_retried_but_not_for_ever(wanted):
    failed = [ran(1, False)] * (2 * RUNS_PER_EPISODE)
    done = [ran(chain, True) for chain in (0, 0, 2, 2)]
    assert wanted.next([*done, *failed[:-1]], []) == [3 * (len(failed) - 1) + 1]
    assert wanted.next([*done, *failed], []) == []
    assert wanted.missing([*done, *failed]) == 2
