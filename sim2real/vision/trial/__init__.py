"""How exact and how fast the vision is, on rendered pictures."""
