"""What holds for all tests."""

import os

# Set before numpy is imported: as in `puckpilot.py`, and because every worker of the tests has a core of its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
