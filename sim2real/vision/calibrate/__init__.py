"""From photographs of a table to table.json: cameras' places, markers, surface, bend."""
