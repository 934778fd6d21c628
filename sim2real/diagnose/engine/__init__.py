"""The engine: regression and model selection on the residuals of any regime, which a regime supplies as a `problem`.

1. `problem`: what a regime supplies - residuals, design matrix, launches (clusters). `law`: a law and a model of laws.
2. `linear`: J'J, J'r and r'r of each unit, kept without what is 0; robust least squares, covariance and the noise in
   units of the sensor's from sums of them.
3. `least_squares`: nonlinear fit of a law's parameters (Levenberg-Marquardt, robust by unit) with 95 % intervals.
4. `forward_selection`: adds laws by cross-validation over units, then eliminates backward what is not needed.
5. `backward_elimination`: refits the model jointly, drops laws of negligible size, and tests for a remaining misfit.
6. `nonparametric`: fits a smooth term; `candidate_models` compares listed laws, a smooth term, and both.
7. `model_search`: runs steps 3 to 6 in order; the entry point of a search.
8. `cross_validation`: rejects laws that do not predict held-out launches.
9. `null_controls`, `alternatives`, `experiment_design`: false discoveries, alternative laws, what to record next.
"""
