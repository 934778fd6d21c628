"""The physical table: a camera's frames through the vision, the board at its port, a person at the other end."""
