"""Robots of RoboTwin: an embodiment's folder becomes a robot of ours."""
