"""Fetch packages through the machine's own configuration: its apt sources and its pip index.

This package contains no address, needs no root, and changes nothing outside the given folder.
"""
