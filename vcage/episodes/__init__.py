"""How episodes are collected, judged, worded and drawn again."""
