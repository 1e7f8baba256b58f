"""Curves, programs and machines without our code, and the shortest times along them: for `scripts/reference-optima` and `scripts/plan-limits`."""
