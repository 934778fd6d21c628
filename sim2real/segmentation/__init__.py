"""From frames to segments: valid frames, noise, changepoints, contacts and their causes."""
