"""What a circle, and several together, look like on a page."""
