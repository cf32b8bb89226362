"""Model calls behind protocols: deterministic offline stand-ins, and clients of real endpoints."""
