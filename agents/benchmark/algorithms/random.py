"""The script `random`, which learns nothing."""

from agents.benchmark.algorithms import Algorithm

ALGORITHM = Algorithm("the script random", "none", lambda assignment, report: "random", learns=False)
