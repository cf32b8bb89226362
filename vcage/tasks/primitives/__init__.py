"""Manipulation primitives: how a pick, a place and the operation of a moving part are planned, carried out and felt."""
