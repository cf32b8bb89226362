"""How the scene of a run comes about: chosen objects, stated goals, starting poses, and checks that it is possible."""
