"""What happens on the independent table while it is recorded, and what a camera says of it."""
