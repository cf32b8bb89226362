"""The one place that imports Rerun, which is an extra."""

from __future__ import annotations

from vcage.base.errors import MissingDependency

try:
    import rerun as rr
    import rerun.blueprint as rrb
except ImportError as error:
    raise MissingDependency(f"Rerun cannot be imported: {error}", hint="pip install 'vcage[view]'") from error

# Otherwise a mistake of ours would be a warning, and a hole in the recording.
rr.set_strict_mode(True)

__all__ = ["rr", "rrb"]
