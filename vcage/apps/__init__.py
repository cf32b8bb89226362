"""Views for people: the page of a run, the viewer, the gallery, the proof of objects by use, and replays."""
