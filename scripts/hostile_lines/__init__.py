"""Hostile command lines: what they are, the inputs that they find, and what an end of one must be. `scripts/hostile` runs them."""
