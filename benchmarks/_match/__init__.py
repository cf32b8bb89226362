"""Parts of ``python -m benchmarks match``: cases on disk, their making, the score, the greedy baseline."""
