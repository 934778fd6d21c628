"""Camera and encoders: coordinate scale and warp, delay, repeated frames."""
