"""Plans of a layout: what relation words mean, whether a plan can be true, and how much of it a layout keeps."""
