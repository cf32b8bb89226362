"""Sentences that others and our own pages give, and a whole run of each."""
