"""Estimators for scikit-learn whose model is a readable rule set: ``pip install flagred[sklearn]``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin
from sklearn.utils import check_random_state
from sklearn.utils.multiclass import check_classification_targets, type_of_target
from sklearn.utils.validation import _check_sample_weight, check_is_fitted, validate_data

from ._conformal import ConformalRegressor
from ._core import Explanation
from ._learning import learn, tune
from ._model import Model

__all__ = ["ConformalRegressor", "FuzzyClassifier", "FuzzyRegressor", "FuzzyRiskClassifier"]

Floats = NDArray[np.float64]

_TERMS = {
    2: ["low", "high"],
    3: ["low", "medium", "high"],
    4: ["low", "fairly_low", "fairly_high", "high"],
    5: ["very_low", "low", "medium", "high", "very_high"],
    6: ["very_low", "low", "fairly_low", "fairly_high", "high", "very_high"],
    7: ["very_low", "low", "fairly_low", "medium", "fairly_high", "high", "very_high"],
}

# The maximum number of combinations of terms if each needs a rule, as with monotone constraints.
_MOST_COMBINATIONS = 100_000


class _FuzzyEstimator(BaseEstimator):  # type: ignore[misc]
    """The common part of the estimators: partitions from the data, rules by Wang and Mendel, numbers by tuning."""

    rule_set_: Model
    n_rules_: int

    def __init__(
        self,
        *,
        n_terms: int = 3,
        n_output_terms: int = 7,
        spacing: Literal["quantile", "uniform"] = "quantile",
        min_support: int = 1,
        complete: bool = False,
        monotonic_cst: Sequence[int] | Mapping[str, int] | None = None,
        tune: bool = True,
        iterations: int = 20,
        starts: int = 1,
        random_state: int | np.random.RandomState | None = None,
    ) -> None:
        self.n_terms = n_terms
        self.n_output_terms = n_output_terms
        self.spacing = spacing
        self.min_support = min_support
        self.complete = complete
        self.monotonic_cst = monotonic_cst
        self.tune = tune
        self.iterations = iterations
        self.starts = starts
        self.random_state = random_state

    def _fit(
        self, X: Floats, y: Floats, weight: Floats, output: str, peaks: Floats, within: tuple[float, float], loss: str
    ) -> None:
        for name in ("n_terms", "n_output_terms"):
            if getattr(self, name) < 2:
                raise ValueError(f"{name} is {getattr(self, name)}, but a variable has at least 2 terms")
        if self.spacing not in ("quantile", "uniform"):
            raise ValueError(f"spacing is {self.spacing!r}, but must be 'quantile' or 'uniform'")
        # A row of weight 0 is ignored.
        counts = weight > 0
        X, y, weight = X[counts], y[counts], weight[counts]
        if len(y) == 0:
            raise ValueError("all weights are 0: there are no rows to learn from")
        names = self._input_names(output)
        rising, falling = self._directions(names)
        model = Model("learned", operators={"and": "product", "implication": "product", "aggregation": "sum"})
        combinations = 1.0
        for name, column in zip(names, X.T, strict=True):
            at = self._peaks(column, weight, self.n_terms)
            combinations *= len(at)
            model.input(name, range=_wider(at), partition=dict(zip(_terms(len(at)), at.tolist(), strict=True)))
        model.output(
            output,
            range=within,
            terms={name: {"singleton": at} for name, at in zip(_terms(len(peaks)), peaks.tolist(), strict=True)},
            when_no_rule_fires={"value": float(np.clip(np.average(y, weights=weight), *within))},
        )
        is_monotone = bool(rising or falling)
        if (is_monotone or self.complete) and combinations > _MOST_COMBINATIONS:
            raise ValueError(
                f"there are {combinations:.3g} combinations of terms, and each would need a rule"
                " (complete, monotonic_cst); use fewer features, or fewer terms"
            )
        columns = dict(zip(names, X.T, strict=True)) | {output: y, "": weight}
        model = learn(
            model,
            columns,
            resolve="mean",
            min_support=self.min_support,
            complete=self.complete or is_monotone,
            rising=rising,
            falling=falling,
            weight="",
            validation=False,
        ).model
        if len(model.rules) == 0:
            raise ValueError(f"no combination of terms has at least min_support={self.min_support} rows")
        if self.tune:
            seed = int(check_random_state(self.random_state).randint(2**31 - 1))
            model = tune(
                model,
                columns,
                loss=loss,  # type: ignore[arg-type]
                rising=rising,
                falling=falling,
                starts=self.starts,
                digits=None,
                iterations=self.iterations,
                seed=seed,
                weight="",
            ).model
        self.rule_set_ = model
        self.n_rules_ = len(model.rules)

    def _input_names(self, output: str) -> list[str]:
        """The names of the features; a feature with the name of the output gets a suffix."""
        names = getattr(self, "feature_names_in_", [f"x{i}" for i in range(self.n_features_in_)])
        return [f"{name}_in" if name == output else str(name) for name in names]

    def _directions(self, names: list[str]) -> tuple[list[str], list[str]]:
        """The inputs whose increase must not lower the output, and those whose increase must not raise it."""
        given = self.monotonic_cst
        if given is None:
            return [], []
        if isinstance(given, Mapping):
            known = list(getattr(self, "feature_names_in_", names))
            for name in given:
                if name not in known:
                    raise ValueError(f"monotonic_cst names {name!r}, which is not a feature")
            signs = [given.get(name, 0) for name in known]
        else:
            signs = list(given)
        if len(signs) != len(names) or any(sign not in (-1, 0, 1) for sign in signs):
            raise ValueError(f"monotonic_cst must contain -1, 0 or 1 for each of the {len(names)} features")
        signed = list(zip(names, signs, strict=True))
        return [name for name, sign in signed if sign == 1], [name for name, sign in signed if sign == -1]

    def _peaks(self, values: Floats, weight: Floats, count: int) -> Floats:
        """The peaks of the terms of a variable, from the lowest value to the highest."""
        low, high = values.min(), values.max()
        if low == high:
            # A constant value contains no information; two terms around it share it.
            width = max(abs(low), 1.0)
            return np.array([low - width, low + width])
        if self.spacing == "uniform":
            return np.linspace(low, high, count)
        order = np.argsort(values, kind="stable")
        below = np.cumsum(weight[order])
        # The smallest value up to which this share of the weight lies: a row of weight 2 counts as two rows.
        found = np.searchsorted(below, np.linspace(0, 1, count)[1:-1] * below[-1])
        return np.unique(np.concatenate(([low], values[order][found], [high])))

    def _rows(self, X: ArrayLike) -> Floats:
        """Validates rows to predict."""
        check_is_fitted(self, "rule_set_")
        rows: Floats = validate_data(self, X, reset=False, dtype=np.float64)
        return rows

    def _evaluate(self, X: ArrayLike) -> Floats:
        rows = self._rows(X)
        found: Floats = np.asarray(self.rule_set_(*rows.T))
        return found

    def explain(self, X: ArrayLike) -> list[Explanation]:
        """Explains the outputs of the rule set: the degrees of the terms and the strengths of the rules.

        Parameters
        ----------
        X
            The rows, as for :meth:`predict`.

        Returns
        -------
        list of Explanation
            One for each row; ``print()`` shows it.
        """
        rows = self._rows(X)
        return [self.rule_set_.explain(*row.tolist()) for row in rows]


def _weights(sample_weight: ArrayLike | None, rows: Floats) -> Floats:
    weights: Floats = _check_sample_weight(sample_weight, rows, dtype=np.float64, ensure_non_negative=True)
    return weights


def _wider(peaks: Floats) -> tuple[float, float]:
    """The range of a variable. It is wider than its values, because a peak at an end of the range cannot move."""
    margin = (peaks[-1] - peaks[0]) / 10
    return float(peaks[0] - margin), float(peaks[-1] + margin)


def _terms(count: int) -> list[str]:
    return _TERMS.get(count) or [f"level_{i}" for i in range(1, count + 1)]


class FuzzyRegressor(RegressorMixin, _FuzzyEstimator):  # type: ignore[misc]
    """A regressor whose model is a fuzzy rule set.

    Each feature gets a partition, derived from its values. Rules are learned after Wang and Mendel (1992): one for each
    combination of terms with rows, whose consequent is the mean of its rows. Then tuning moves the peaks and the
    consequents. A prediction is the mean of the consequents, weighted by the firing strengths; where no rule fires, it is
    the mean of the training targets. It exceeds their range by at most a tenth of its width.

    Parameters
    ----------
    n_terms
        The maximum number of terms of a feature. Features with few values get fewer.
    n_output_terms
        The maximum number of terms of the target.
    spacing
        The initial positions of the terms: at quantiles of the values, or evenly spaced.
    min_support
        The minimum number of rows of a rule.
    complete
        Whether combinations of terms without rows get the rule of the nearest one with rows.
    monotonic_cst
        For each feature 1 (the prediction does not fall as it rises), -1 (it does not rise) or 0; or a mapping of names of
        features to these. Every combination of terms then gets a rule.
    tune
        Whether the numbers are tuned.
    iterations
        The maximum number of iterations of tuning, for each start.
    starts
        The number of starts of tuning: first at the learned rules, then at random points around them.
    random_state
        The random seed of these points.

    Attributes
    ----------
    rule_set_
        The rule set, a :class:`flagred.Model`.
    n_rules_
        The number of its rules.
    n_features_in_, feature_names_in_
        The features.

    Examples
    --------
    >>> import numpy as np
    >>> from flagred.sklearn import FuzzyRegressor
    >>> heat = np.arange(41.0)
    >>> speed = 2 + 6 * np.clip((heat - 20) / 10, 0, 1)
    >>> fan = FuzzyRegressor(n_terms=2, n_output_terms=2).fit(heat[:, None], speed)
    >>> fan.predict([[10], [25], [40]]).round(1)
    array([2., 5., 8.])
    >>> [rule.text for rule in fan.rule_set_.rules]
    ['IF x0 IS low THEN y IS low', 'IF x0 IS high THEN y IS high']
    """

    def fit(self, X: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> FuzzyRegressor:
        """Learns the rule set.

        Parameters
        ----------
        X, y
            The rows and their targets.
        sample_weight
            The weight of each row.
        """
        rows, targets = validate_data(self, X, y, dtype=np.float64, y_numeric=True)
        targets = targets.astype(np.float64)
        weight = _weights(sample_weight, rows)
        used = weight > 0
        peaks = self._peaks(targets[used], weight[used], self.n_output_terms) if used.any() else np.array([0.0, 1.0])
        self._fit(rows, targets, weight, "y", peaks, _wider(peaks), "squared")
        return self

    def predict(self, X: ArrayLike) -> Floats:
        """The outputs of the rule set.

        Parameters
        ----------
        X
            The rows. Values outside the range of a feature in the rule set are clamped.
        """
        return self._evaluate(X)


class FuzzyRiskClassifier(ClassifierMixin, _FuzzyEstimator):  # type: ignore[misc]
    """A classifier of two classes whose model is a fuzzy rule set: the risk of the second class, from 0 to 1.

    It learns like :class:`FuzzyRegressor`, from 0 for the first class and 1 for the second. Tuning minimises the mean of
    -ln p of the true classes.

    Parameters
    ----------
    n_terms, n_output_terms, spacing, min_support, complete, monotonic_cst, tune, iterations, starts, random_state
        As for :class:`FuzzyRegressor`.

    Attributes
    ----------
    classes_
        The two classes, sorted.
    rule_set_
        The rule set, a :class:`flagred.Model`. Its output is the risk.
    n_rules_
        The number of its rules.
    n_features_in_, feature_names_in_
        The features.

    Examples
    --------
    >>> import numpy as np
    >>> from flagred.sklearn import FuzzyRiskClassifier
    >>> margin = np.linspace(0, 1, 40)[:, None]
    >>> crashed = margin[:, 0] < 0.4
    >>> risk = FuzzyRiskClassifier(monotonic_cst=[-1]).fit(margin, crashed)
    >>> risk.predict([[0.1], [0.9]])
    array([ True, False])
    >>> bool(risk.predict_proba([[0.1]])[0, 1] > 0.9)
    True
    """

    classes_: NDArray[Any]

    def fit(self, X: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> FuzzyRiskClassifier:
        """Learns the rule set, like :meth:`FuzzyRegressor.fit`, from rows ``X`` and their classes ``y``."""
        rows, classes = validate_data(self, X, y, dtype=np.float64)
        check_classification_targets(classes)
        kind = type_of_target(classes, input_name="y", raise_unknown=True)
        if kind != "binary":
            raise ValueError(f"Only binary classification is supported. The type of the target is {kind}.")
        weight = _weights(sample_weight, rows)
        self.classes_, places = np.unique(classes, return_inverse=True)
        if len(np.unique(places[weight > 0])) < 2:
            raise ValueError("FuzzyRiskClassifier needs rows of 2 classes; there is 1 class")
        peaks = (np.arange(self.n_output_terms) + 0.5) / max(self.n_output_terms, 1)
        self._fit(rows, places.astype(np.float64), weight, "risk", peaks, (0.0, 1.0), "log")
        return self

    def predict_proba(self, X: ArrayLike) -> Floats:
        """The probabilities of both classes for rows ``X``. That of the second is the output of the rule set."""
        risk = self._evaluate(X)
        return np.column_stack((1.0 - risk, risk))

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """The class with the greater probability for each of the rows ``X``; the first of equal ones."""
        places = np.argmax(self.predict_proba(X), axis=1)
        found: NDArray[Any] = self.classes_[places]
        return found

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.classifier_tags.multi_class = False
        return tags


class FuzzyClassifier(ClassifierMixin, _FuzzyEstimator):  # type: ignore[misc]
    """A classifier of two or more classes: one rule set for each, whose output is the degree to which a row belongs to it,
    from 0 to 1.

    Each rule set is learned like that of :class:`FuzzyRiskClassifier`, for its class against all others. The probabilities
    are these degrees divided by their sum.

    Parameters
    ----------
    n_terms, n_output_terms, spacing, min_support, complete, tune, iterations, starts, random_state
        As for :class:`FuzzyRegressor`.
    monotonic_cst
        As for :class:`FuzzyRegressor`; only for two classes, where it concerns the second.

    Attributes
    ----------
    classes_
        The classes, sorted.
    rule_sets_
        The rule set of each class, each a :class:`flagred.Model`; for two classes, only that of the second.
    n_rules_
        The number of their rules.
    n_features_in_, feature_names_in_
        The features.

    Examples
    --------
    >>> import numpy as np
    >>> from flagred.sklearn import FuzzyClassifier
    >>> size = np.linspace(0, 3, 90)[:, None]
    >>> kind = np.array(["small", "medium", "large"])[size[:, 0].astype(int).clip(0, 2)]
    >>> sizes = FuzzyClassifier(n_terms=5).fit(size, kind)
    >>> sizes.predict([[0.3], [1.5], [2.8]]).tolist()
    ['small', 'medium', 'large']
    >>> sizes.predict_proba([[1.5]]).sum().round(6).item()
    1.0
    """

    classes_: NDArray[Any]
    rule_sets_: list[Model]

    def fit(self, X: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> FuzzyClassifier:
        """Learns the rule sets from rows ``X`` and their classes ``y``."""
        rows, classes = validate_data(self, X, y, dtype=np.float64)
        check_classification_targets(classes)
        weight = _weights(sample_weight, rows)
        self.classes_, places = np.unique(classes, return_inverse=True)
        if len(np.unique(places[weight > 0])) < 2:
            raise ValueError("FuzzyClassifier needs rows of 2 classes; there is 1 class")
        if len(self.classes_) > 2 and self.monotonic_cst is not None:
            raise ValueError("monotonic_cst requires exactly two classes")
        peaks = (np.arange(self.n_output_terms) + 0.5) / max(self.n_output_terms, 1)
        first = 1 if len(self.classes_) == 2 else 0
        self.rule_sets_ = []
        for place in range(first, len(self.classes_)):
            of_class = (places == place).astype(np.float64)
            self._fit(rows, of_class, weight, "degree", peaks, (0.0, 1.0), "log")
            self.rule_sets_.append(self.rule_set_)
        del self.rule_set_
        self.n_rules_ = sum(len(rule_set.rules) for rule_set in self.rule_sets_)
        return self

    def predict_proba(self, X: ArrayLike) -> Floats:
        """The probability of each class for each of the rows ``X``."""
        check_is_fitted(self, "rule_sets_")
        rows: Floats = validate_data(self, X, reset=False, dtype=np.float64)
        degrees = np.column_stack([rule_set(*rows.T) for rule_set in self.rule_sets_])
        if degrees.shape[1] == 1:
            return np.column_stack((1.0 - degrees, degrees))
        sums = degrees.sum(axis=1, keepdims=True)
        even = np.full_like(degrees, 1.0 / degrees.shape[1])
        found: Floats = np.divide(degrees, sums, out=even, where=sums > 0)
        return found

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """The class with the greatest probability for each of the rows ``X``; the first of equal ones."""
        places = np.argmax(self.predict_proba(X), axis=1)
        found: NDArray[Any] = self.classes_[places]
        return found

    def explain(self, X: ArrayLike) -> list[list[Explanation]]:  # type: ignore[override]
        """Explains the degrees of each rule set: for each of the rows ``X``, the explanation of each of ``rule_sets_``."""
        check_is_fitted(self, "rule_sets_")
        rows: Floats = validate_data(self, X, reset=False, dtype=np.float64)
        return [[rule_set.explain(*row.tolist()) for rule_set in self.rule_sets_] for row in rows]
