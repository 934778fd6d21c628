"""The engine: regression and model selection on any regime's residuals. It knows no regime; a regime is a `problem`.

1. `problem`: what a regime supplies - residuals, design matrix, launches (clusters). `law`: a law and a model of laws.
2. `normal_equations`: J'J, J'r and r'r of each unit; robust least squares and covariance from sums of them.
3. `least_squares`: nonlinear fit of a law's parameters (Levenberg-Marquardt, robust by unit) with 95 % intervals.
4. `forward_selection`: adds laws by cross-validation over units, then eliminates backward what is not needed.
5. `backward_elimination`: refits the model jointly, drops laws of no size, and asks whether a misfit remains.
6. `nonparametric`: fits a smooth term; `candidate_models` weighs listed laws, a smooth term, or both.
7. `model_search`: steps 3 to 6 in order, the one entry point of a search.
8. `cross_validation`: rejects laws that do not predict launches which they were not fitted to.
9. `null_controls`, `alternatives`, `experiment_design`: how sure a law is, what else would do, what to record next.
"""
