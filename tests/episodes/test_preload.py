from __future__ import annotations

import json
import subprocess
import sys

import pytest

NEEDED = ["sapien", "vcage.datasets.packing.clips", "vcage.sim.speed_profile"]


@pytest.mark.slow
def test_modules_for_collecting_and_compressing_are_preloaded_and_missing_ones_left_to_their_users():
    code = (
        "import json, sys; sys.modules['pycvvdp'] = None; import vcage.episodes.preload; "
        "print(json.dumps([*sys.modules]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert set(NEEDED) <= set(json.loads(done.stdout))
