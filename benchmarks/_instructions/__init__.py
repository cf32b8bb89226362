"""Sentences with what they ask for, in five scenes; some were written before the parser and are never tuned to."""
