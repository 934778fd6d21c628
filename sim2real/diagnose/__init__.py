"""Diagnosis of recordings: split, identification by regime, proof on the holdout, result, output files, report."""
