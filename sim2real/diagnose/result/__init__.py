"""What a diagnosis says, as data."""
