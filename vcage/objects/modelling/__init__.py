"""Helpers for models of objects: solids, convex pieces, texture mappings, painted surfaces, and the built object."""
