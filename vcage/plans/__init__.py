"""Plans of a layout: the meaning of relation words, the consistency of a plan, and its share kept by a layout."""
