"""Linear least squares on sums of units: the sums, solutions and covariances, the noise that they leave."""
