"""Blind validation of `puckpilot diagnose` on simulated tables with known concealed effects.

The path of a case: `making` (`independent_table` draws and records it) -> `diagnosing` (a process that sees only a copy
of the recording) -> `scoring` (against the key) -> `figures` and `confusion`.
"""
