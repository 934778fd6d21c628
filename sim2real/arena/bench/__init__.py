"""How quick the arena is, and what it bears: a browser behind a bad line, and many pages at once."""
