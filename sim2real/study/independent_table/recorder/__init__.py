"""Scenes on the independent table, and their recordings by a simulated camera and encoders."""
