"""What the puck meets - walls, posts, goal lines, mallets - and the impulse there."""
