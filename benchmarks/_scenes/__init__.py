"""Layouts and tasks of the benchmark of the five scenes."""
