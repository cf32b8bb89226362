"""The parts of the policy benchmark."""
