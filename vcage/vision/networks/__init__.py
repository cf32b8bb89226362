"""Neural detectors and embedders that run on this machine, from a hub's weights, a folder's, or a package's."""
