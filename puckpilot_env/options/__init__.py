"""What a caller may hand over - numbers, effects, draws - and how it is checked."""
