"""Intervals of predictions by split conformal prediction."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, MetaEstimatorMixin, RegressorMixin, clone
from sklearn.model_selection import GroupShuffleSplit, ShuffleSplit
from sklearn.utils import _safe_indexing
from sklearn.utils.validation import check_is_fitted, validate_data

__all__ = ["ConformalRegressor"]


class ConformalRegressor(RegressorMixin, MetaEstimatorMixin, BaseEstimator):  # type: ignore[misc]
    """A regressor that also predicts intervals, by split conformal prediction (Lei et al. 2018).

    Part of the training rows is excluded from the fit. The errors on these calibration rows determine the width of the
    intervals: one width for all rows. An interval of 90 % contains the target of at least 90 % of new rows on average, if
    new rows come from the same source as the training rows. This does not apply to rows of one kind alone, or to unseen
    vehicles unless ``groups`` are given.

    Parameters
    ----------
    estimator
        The regressor; by default a :class:`FuzzyRegressor`.
    calibration_size
        The share of the training rows, or groups, that is excluded from the fit.
    random_state
        The random seed of the calibration rows.

    Attributes
    ----------
    estimator_
        The fitted regressor.
    errors_
        The absolute errors on the calibration rows, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> from flagred.sklearn import ConformalRegressor
    >>> random = np.random.default_rng(0)
    >>> X = random.uniform(0, 6, (400, 1))
    >>> y = np.sin(X[:, 0]) + random.normal(0, 0.1, 400)
    >>> regressor = ConformalRegressor(random_state=0).fit(X, y)
    >>> low, high = regressor.predict_interval([[1.5]], coverage=0.9)[0]
    >>> bool(low < np.sin(1.5) < high)
    True
    """

    def __init__(
        self,
        estimator: Any = None,
        *,
        calibration_size: float = 0.25,
        random_state: int | np.random.RandomState | None = None,
    ) -> None:
        self.estimator = estimator
        self.calibration_size = calibration_size
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None) -> ConformalRegressor:
        """Fits the regressor and measures its errors on the calibration rows.

        Parameters
        ----------
        X, y
            The rows and their targets.
        groups
            A group for each row, such as its vehicle. All rows of a group are on the same side.
        """
        from .sklearn import FuzzyRegressor

        rows, targets = validate_data(self, X, y, dtype=np.float64, y_numeric=True, ensure_min_samples=2)
        if not 0 < self.calibration_size < 1:
            raise ValueError(f"calibration_size is {self.calibration_size}, but must be above 0 and below 1")
        splitter = ShuffleSplit if groups is None else GroupShuffleSplit
        split = splitter(1, test_size=self.calibration_size, random_state=self.random_state)
        fitted, left_out = next(split.split(rows, targets, groups))
        # Rows of a frame keep the names of the columns.
        named = X if hasattr(X, "columns") else rows
        estimator = FuzzyRegressor() if self.estimator is None else self.estimator
        self.estimator_ = clone(estimator).fit(_safe_indexing(named, fitted), targets[fitted])
        predicted = self.estimator_.predict(_safe_indexing(named, left_out))
        self.errors_ = np.sort(np.abs(targets[left_out] - predicted))
        return self

    def predict(self, X: ArrayLike) -> NDArray[np.float64]:
        """The predictions of the regressor for the rows ``X``."""
        check_is_fitted(self)
        rows = validate_data(self, X, dtype=np.float64, reset=False)
        found: NDArray[np.float64] = self.estimator_.predict(X if hasattr(X, "columns") else rows)
        return found

    def predict_interval(self, X: ArrayLike, coverage: float = 0.9) -> NDArray[np.float64]:
        """The lower and the upper end of an interval for each of the rows ``X``, as two columns.

        Parameters
        ----------
        X
            The rows.
        coverage
            The share of new rows whose targets the intervals contain, above 0 and below 1.
        """
        if not 0 < coverage < 1:
            raise ValueError(f"coverage is {coverage}, but must be above 0 and below 1")
        predicted = self.predict(X)
        errors = len(self.errors_)
        # The error of a new row is equally likely to have any rank among `errors + 1`. With a probability of at least
        # `coverage`, it is therefore at most the error of this rank.
        rank = math.ceil((errors + 1) * coverage)
        if rank > errors:
            needed = math.ceil(coverage / (1 - coverage))
            raise ValueError(f"intervals of {coverage:.0%} need {needed} calibration rows, but there are {errors}")
        width = self.errors_[rank - 1]
        return np.column_stack((predicted - width, predicted + width))
