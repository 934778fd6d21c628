"""The delay from a frame's exposure to the mallet's motion, in parts with intervals.

- `strokes`: a small program that moves the mallet to and fro; `measure` plays it on a live table.
- `path_shift`: the delay and drift between two clocks that both saw the mallet's path.
- `camera`, `gantry`: the parts that these determine.
- `parts`: all parts of a measurement or of ordinary recordings; `table_text`, how they are printed.
- `injection`: delays of a twin that are known beforehand.
"""
