"""One-line formulas for effects that no listed law explains: `shapes` has functional forms, `search` selects one."""
