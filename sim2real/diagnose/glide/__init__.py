"""Free glides: what brakes and pushes the puck between two contacts."""
