"""What the wall and mallet regimes share: contacts as data, residuals, candidates and formulas."""
