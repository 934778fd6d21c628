"""The compiled board: its state as one record, the bus, exceptions, and how time passes and the program runs."""
