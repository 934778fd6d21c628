"""Pictures of a table as a camera sees it, exact to a few micrometres at the table: what vision is tested against."""
