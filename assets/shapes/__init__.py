"""What several objects are made from; a `model.py` imports it from `assets.shapes`, wherever the project's data lie."""
