"""The noise model of the puck's measured places, with which residuals are whitened."""
