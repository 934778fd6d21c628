"""Explaining a recording: pieces, prediction, location, names, refit, report; a file a stage."""
