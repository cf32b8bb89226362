"""Packages of others, fetched through the machine's own configuration: its apt sources and its pip index.

No address is written here, nothing needs root, and nothing outside the folder given is changed.
"""
