"""Runs as environments, and policies evaluated in them."""
