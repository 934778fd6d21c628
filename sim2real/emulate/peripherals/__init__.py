"""The microcontroller's peripherals, each with its registers (base class in `registers.py`), and the encoders
(`as5147.py`) and motor drivers (`motors.py`) that are wired to them."""
