"""Assets: words and points come from ``asset.json``, geometry from parametric builders at run time.

Entry point: :class:`vcage.objects.library.Library`.
"""
