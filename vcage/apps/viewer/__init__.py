"""An episode in the viewer Rerun: pictures, 3D scene, joints, and what was verified, on one timeline.

Needs the extra ``view``. Entities, timelines and the viewer's layout: https://rerun.io/docs/concepts.
"""
