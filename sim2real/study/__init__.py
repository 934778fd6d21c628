"""The proof of `puckpilot diagnose`: tables with something hidden, what it says of them, and how often it is right.

The path of a case: `making` (`independent_table` draws and records it) -> `diagnosing` (a process
that sees a copy of the recording alone) -> `scoring` (the key is opened) -> `figures` and `confusion`.
"""
