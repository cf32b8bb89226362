"""Draw one small picture with SAPIEN and print the result as JSON.

Run as a process of its own (``python -m vcage.setup.render_probe``), because a Vulkan driver that does not suit
SAPIEN may abort instead of raising. :func:`vcage.setup.vulkan.probe` does that.
"""

from __future__ import annotations

import json

MIN_CONTRAST = 0.05
"""Standard deviation of the colour values in [0, 1] that a lit red box before a grey background exceeds by far."""


def draw() -> dict[str, str | bool]:
    """Draw a lit red box: ``{"device": name of the Vulkan device, "blank": whether the picture shows nothing}``."""
    import sapien

    system = sapien.render.RenderSystem()
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), system])
    scene.set_ambient_light([0.3, 0.3, 0.3])
    scene.add_directional_light([1, 0.5, -1], [2, 2, 2])
    box = scene.create_actor_builder()
    box.add_box_visual(half_size=(0.1, 0.1, 0.1), material=(0.8, 0.1, 0.1))
    box.build_static()
    camera = scene.add_camera("probe", width=64, height=48, fovy=1.0, near=0.01, far=10)
    camera.set_entity_pose(sapien.Pose([-0.5, 0, 0]))
    scene.update_render()
    camera.take_picture()
    contrast = camera.get_picture("Color")[..., :3].std()
    return {"device": system.device.name, "blank": bool(contrast < MIN_CONTRAST)}


if __name__ == "__main__":
    print(json.dumps(draw()))
