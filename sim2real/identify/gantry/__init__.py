"""The gantry: its laws, the free run, the fit, and the choice of a law."""
