"""The engine: fits laws to a regime's residuals and decides which of them the recording asks for."""
