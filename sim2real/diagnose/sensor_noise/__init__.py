"""The noise model of the puck's measured positions, used to whiten residuals."""
