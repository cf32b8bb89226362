"""What people look at: the page of a run, the viewer, the gallery, and the proof of objects by use."""
