"""Formulas of one line for what no listed law explains: `shapes` are functional forms, `search` finds the best."""
