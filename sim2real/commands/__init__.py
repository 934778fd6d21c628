"""Commands that need recordings, cameras or boards."""
