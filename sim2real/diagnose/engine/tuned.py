"""Tuned numbers of the engine, in the order of its files. Losses are sums of squares in units of the noise."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class EngineNumbers:
    """Thresholds of model selection, and limits of its iterations."""

    # normal_equations
    rank_tolerance: float = tuned(
        1e-10,
        "of the greatest eigenvalue",
        "rounding errors taken for information",
        "choice: above double precision's 1e-16",
    )
    reweighting_rounds: int = tuned(8, "rounds", "weights that alternate without end", "choice: ample for convergence")
    reweighting_change: float = tuned(
        0.03, "of a weight", "rounds without effect", "choice: far below an effect on decisions"
    )
    # least_squares
    fit_rounds: int = tuned(40, "rounds", "a fit that never ends", "choice: ample for Gauss-Newton")
    fit_decrease: float = tuned(
        1e-3, "of the mean loss of a residual", "rounds without effect", "choice: far below any threshold"
    )
    fit_halvings: int = tuned(3, "halvings", "residual evaluations for useless steps", "choice: an eighth of a step")
    profile_halvings: int = tuned(5, "halvings", "a coarse end of an interval, or fits", "choice: to a thirtieth")
    exploring_rounds: int = tuned(4, "rounds", "full fits from every start", "choice: a tenth of fit_rounds")
    # forward_selection
    unit_folds: int = tuned(10, "folds", "fits to few data, or many fits", "choice: the usual number")
    fit_gain: float = tuned(
        30.0,
        "loss",
        "laws that fit noise, selected from many",
        "choice: far in the tail of chi-square with 1 degree of freedom",
    )
    cv_gain: float = tuned(12.0, "loss", "laws that fit but do not predict", "choice: less than half of fit_gain")
    cv_gain_elsewhere: float = tuned(
        2.0, "loss", "laws that a single launch supports", "choice: AIC's price of one parameter"
    )
    bootstrap_draws: int = tuned(400, "draws", "a noisy quantile, or time", "choice: 8 draws below the quantile")
    bootstrap_quantile: float = tuned(
        0.02, "of draws", "laws that few launches support, or missed laws", "choice: about two standard deviations"
    )
    sign_information: float = tuned(
        4.0, "loss per column", "a sign determined by noise", "choice: two standard deviations of each coefficient"
    )
    share_of_explained: float = tuned(
        0.05, "of what all laws explain", "small laws that compensate errors of large ones", "choice: a twentieth"
    )
    share_of_noise: float = tuned(
        0.05, "of the noise's loss", "real laws dropped beside a very strong one", "choice: 2.5 % of the rms"
    )
    proving_share: float = tuned(
        0.5, "of the excess over noise", "a smooth term that approximates another law", "choice: most of it"
    )
    ambiguity: float = tuned(
        9.0, "loss", "a name where other laws explain the data as well", "choice: three standard deviations"
    )
    nonlinear_ridge: float = tuned(
        0.1,
        "1",
        "coefficients far from the point of linearization",
        "choice: a prior standard deviation of 3 for coefficients of 1",
    )
    spreads: tuple[float, ...] = tuned(
        (0.03, 0.3, 3.0), "1", "smooth terms too stiff or too free", "choice: factors of ten"
    )
    dispersion_ridge: float = tuned(
        1e-6, "1", "coefficients without data", "choice: far below the information of one residual"
    )
    # backward_elimination
    default_p: float = tuned(
        1e-4, "p-value", "default parameters rejected though they are right", "choice: once in 10,000 recordings"
    )
    misfit: float = tuned(
        2.0, "reduced chi-square above 1", "a false alarm for slightly larger noise", "choice: noise larger by 70 %"
    )
    misfit_beside_laws: float = tuned(
        0.3, "reduced chi-square above 1", "a second law missed", "choice: noise larger by 14 %"
    )
    misfit_left: float = tuned(
        0.3, "of the baseline's misfit", "imperfect laws taken for missing ones", "choice: a third remains unexplained"
    )
    misfit_launches: float = tuned(
        0.25, "of launches", "a false alarm for outliers, such as unrecorded contacts", "choice: outliers are few"
    )
    negligible_share: float = tuned(
        0.1,
        "of the baseline's excess",
        "a smooth term for a remainder that is small beside listed laws",
        "choice: a third of the rms",
    )
    negligible_noise: float = tuned(
        1.0, "of the noise's loss", "a remainder larger than the noise left unexplained", "choice: as much as the noise"
    )
    outlying_excess: float = tuned(
        6.0,
        "times the median",
        "outlying launches",
        "choice: far beyond the scatter of chi-square",
    )
    outlying_share: float = tuned(0.1, "of launches", "data deleted until a law fits", "choice: outliers are few")
    leverage_median: float = tuned(
        1.5, "reduced chi-square", "launches deleted although all fit", "choice: noise larger by 22 %"
    )
    leverage_excess: float = tuned(
        30.0,
        "times the median",
        "regular launches deleted",
        "choice: far beyond the scatter of chi-square",
    )
    leverage_decrease: float = tuned(
        0.5, "of the median", "launches deleted without effect", "choice: the deletion removes most of the misfit"
    )
    wald_size: float = tuned(
        20.0, "loss", "laws that vanish in the joint nonlinear fit", "choice: more than four standard deviations"
    )
    # candidate_models
    residuals_per_coefficient: float = tuned(
        7.0, "residuals", "smooth terms that follow the noise", "choice: several residuals a coefficient"
    )
    remainder: float = tuned(
        0.1,
        "of what listed laws explain",
        "a smooth term that compensates errors of listed laws",
        "choice: less is their inaccuracy",
    )
    remainder_of_excess: float = tuned(
        0.25, "of their excess over noise", "a smooth term that explains little of the remainder", "choice: a quarter"
    )
    sufficient: float = tuned(
        2.0 / 3.0, "of what a smooth term explains", "listed laws that approximate another law", "choice: two thirds"
    )
    few_listed: int = tuned(
        2, "laws", "many listed laws that approximate one other", "choice: more are implausible beside one"
    )
    joint_laws: int = tuned(
        3, "laws", "time, and laws that compensate errors of a smooth term", "choice: the term and two others"
    )
    fitted_terms: int = tuned(2, "terms", "time of nonlinear fits", "choice: best fit and best prediction")
    # model_search
    most_listed: int = tuned(
        4, "laws", "time, and laws that compensate errors of others", "choice: more are implausible"
    )
    calibration_errors: float = tuned(
        2.0, "times the calibration's error", "errors of a camera's map named as laws", "choice: twice the error's rms"
    )
    # nonparametric
    term_rounds: int = tuned(8, "rounds", "time", "choice: ample for Gauss-Newton")
    term_decrease: float = tuned(0.002, "of the loss", "rounds without effect", "choice: a small share")
    term_halvings: int = tuned(4, "step lengths", "time for useless steps", "choice: down to an eighth")
    # cross_validation
    launch_folds: int = tuned(5, "folds", "fits to few launches, or many fits", "choice: the usual number")
    share_of_excess: float = tuned(
        0.1, "of the excess over noise", "laws of hardly any use", "choice: 5 % of the rms beyond noise"
    )
    sensitivity: float = tuned(
        16.0, "loss", "a decision by chance where launches are insensitive to a law", "choice: four standard deviations"
    )
    # alternatives and experiment_design
    nearly_as_good: float = tuned(
        0.995, "of the selected model's gain", "100 % printed for a worse model", "choice: it rounds to 100 %"
    )
    discriminating: float = tuned(
        18.0,
        "loss",
        "advice that is sufficient only by chance",
        "choice: twice the ambiguity, since half may be chance",
    )
    richer_kind: float = tuned(
        1.2,
        "times the average",
        "advice where all kinds are equally informative",
        "choice: a fifth more is worth the effort",
    )
    fewest_of_kind: int = tuned(
        4, "units", "an average of too few units", "choice: a standard error of half the scatter"
    )
    most_to_record: int = tuned(1000, "units", "advice that nobody can follow", "choice: an hour of glides")
    # null_controls
    null_draws: int = tuned(
        6, "draws", "time, a search each", "choice: a false discovery rate of one in six would show"
    )


ENGINE = EngineNumbers()
