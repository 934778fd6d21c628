"""A diagnosis as files: JSON, effects.toml, draws.toml."""
