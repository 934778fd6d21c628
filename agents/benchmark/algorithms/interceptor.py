"""The script `interceptor`, which learns nothing."""

from agents.benchmark.algorithms import Algorithm

ALGORITHM = Algorithm("the script interceptor", "none", lambda assignment, report: "interceptor", learns=False)
