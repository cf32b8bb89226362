"""Chains of sub-tasks that are carried out with failures planted in them."""
