"""A small policy that learns from an export, and the parts of the policy benchmark."""
