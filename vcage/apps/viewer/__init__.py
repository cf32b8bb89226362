"""An episode in the viewer Rerun: pictures, 3D scene, joints, and verdicts, on one timeline.

Needs the extra ``view``. Entities, timelines and the viewer's layout: https://rerun.io/docs/concepts.
"""
