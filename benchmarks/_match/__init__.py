"""Parts of ``python -m benchmarks match``: cases on disk, their making, the score, the paper's plain rule."""
