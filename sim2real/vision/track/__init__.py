"""From pictures and table.json to where puck and opponent are."""
