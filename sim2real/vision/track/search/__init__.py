"""Where in a picture an object is searched: the region round a place, that in parts, and both for a track."""
