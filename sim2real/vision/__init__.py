"""From photographs to metres: the camera, the markers round the table, and its surface."""
