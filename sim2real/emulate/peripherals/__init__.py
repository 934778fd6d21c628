"""The microcontroller's peripherals, a file each, and the parts that are wired to them: each a record of its state, and
the kernels that answer an access to its registers or an event."""
