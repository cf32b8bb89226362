"""The HTML page of a run: everything that was made, judged and refused, in one self-contained file."""
