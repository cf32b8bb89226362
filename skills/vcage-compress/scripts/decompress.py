#!/usr/bin/env python3
"""Put the pictures of compressed recordings back."""

from vcage_environment import main

if __name__ == "__main__":  # processes that it starts read it again
    main("decompress")
