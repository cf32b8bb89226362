"""The chain: one module per stage, each reading the file of the stage before and writing its own."""
