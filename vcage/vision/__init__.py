"""Pictures compared: colour, the empty table, registration, how well an object fits at a pose; detectors, embedders."""
