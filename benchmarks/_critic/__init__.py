"""Outcomes of sub-tasks whose truth the simulator knows, for critics to be counted on."""
