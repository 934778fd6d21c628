"""The report of a diagnosis: one self-contained HTML page with text, tables and figures."""
