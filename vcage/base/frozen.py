"""Imported last by the process that others are forked from (:func:`vcage.base.workers.load_ahead`): what it has loaded
stays out of every garbage collection, so that its memory is shared, and the process ends at once."""

import gc

gc.freeze()
