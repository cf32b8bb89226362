"""Action-aware perceptual compression (paper, section III-D): keyframes, ColorVideoVDP, HEVC and the CRF search."""
