"""The small painted world, in which no renderer is needed."""

from tests.painted_world import background, camera, detect, make_scene, moved, paint, things

__all__ = ["background", "camera", "detect", "make_scene", "moved", "paint", "things"]
