"""Curves and machines, published and drawn by a seed, and the shortest times along them. `scripts/reference-optima` runs them."""
