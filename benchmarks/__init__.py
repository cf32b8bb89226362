"""Benchmarks: timings and rates, measured against others in the same run."""
