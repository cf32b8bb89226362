"""From the target picture to where every object stands in it (paper, section III-A3)."""
