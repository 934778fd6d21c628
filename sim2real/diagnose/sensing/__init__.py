"""What the camera and its clock do to a recording: late stamps, a drifting clock, a stretched map, held frames."""
