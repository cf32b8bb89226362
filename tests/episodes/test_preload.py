from __future__ import annotations

import json
import subprocess
import sys

NEEDED = ["pycvvdp", "sapien", "torch", "vcage.datasets.packing.clips", "vcage.sim.trajectory"]


def test_modules_for_collecting_and_compressing_are_preloaded():
    code = "import json, sys, vcage.episodes.preload; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert set(NEEDED) <= set(json.loads(done.stdout))


def test_modules_that_cannot_be_imported_are_left_to_their_users():
    code = "import sys; sys.modules['pycvvdp'] = None; import vcage.episodes.preload; print('sapien' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "True\n"
