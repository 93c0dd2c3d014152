"""Learning of rules and tuning of numbers from rows of data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal, NamedTuple

from ._arrays import array
from ._core import _learn, _tune
from .errors import DataError
from ._model import Model, _read
from ._tables import column_of, groups_of, names_of, same_length, table_of, whole_numbers

__all__ = ["ChangedNumber", "Errors", "Figure", "LearnResult", "TuneInterrupted", "TuneResult", "TuneValidation", "learn", "tune"]


class Errors(NamedTuple):
    """Errors of predictions."""

    rows: int
    """The rows with a prediction."""
    without_prediction: int
    rmse: float
    """The root mean square of the error."""
    mean_absolute: float
    bias: float
    """The mean of prediction minus truth."""


class LearnResult(NamedTuple):
    """Rules learned from rows."""

    model: Model
    """The rule set with the learned rules."""
    rows: int
    refused: list[str]
    """The reasons why rows were skipped."""
    rules: int
    """The number of learned rules."""
    conflicts: int
    """Combinations of terms whose rows disagree."""
    missing: int
    """Combinations of terms without a rule."""
    left_out: int
    """Combinations of terms with too few rows, or with too low a confidence."""
    completed: int
    """Rules for combinations of terms without rows, each copied from the nearest combination with rows."""
    moved: int
    """Rules whose consequent was moved for ``rising`` and ``falling``."""
    counterexamples: list[str]
    """Positions where the output still contradicts ``rising`` and ``falling``."""
    validation: Errors | None
    """Cross-validation errors; None if they were not requested."""


class ChangedNumber(NamedTuple):
    """A number that was changed by tuning."""

    of: str
    """``variable.term``, or ``rule 3`` counted from 1."""
    name: str
    """``peak`` of a partition, the parameter of a membership function, ``constant``, ``weight``."""
    before: float
    after: float


class Figure(NamedTuple):
    """A figure and its 95 % interval, computed by resampling the groups, or the rows if there are no groups."""

    value: float
    low: float
    high: float


class TuneValidation(NamedTuple):
    """Losses in cross-validation."""

    folds: int
    before: Figure
    """The loss of the original model."""
    after: Figure
    """The loss when each fold is predicted by a model that was tuned on the other folds."""
    gain: Figure


class TuneResult(NamedTuple):
    """A rule set with tuned numbers."""

    model: Model
    rows: int
    refused: list[str]
    """The reasons why rows were skipped."""
    before: float
    """The loss of the original model, on the training rows."""
    after: float
    """The loss of the tuned model on the training rows."""
    without_value: int
    """Rows without a value of the tuned model; they count as the middle of the range."""
    moved: list[ChangedNumber]
    at_bounds: list[str]
    """Constants, as ``variable.term``, at an end of the range beyond which the loss would be smaller."""
    validation: TuneValidation | None
    """None if ``folds`` was not given."""


class TuneInterrupted(KeyboardInterrupt):
    """Raised by Ctrl-C during :func:`tune`. It contains the best rule set so far.

    ``except flagred.TuneInterrupted as stop: tuned = stop.best``. Without such a handler, it ends the program like any
    Ctrl-C.
    """

    best: TuneResult
    """The best result so far, without a validation."""

    def __init__(self, best: TuneResult) -> None:
        super().__init__(best)
        self.best = best

    def __str__(self) -> str:
        return "tuning was interrupted; `best` of this exception is the best rule set so far"


def learn(
    model: Model,
    data: Any,
    *,
    resolve: Literal["strongest", "heaviest", "mean"] = "strongest",
    min_support: int = 1,
    min_degree: float = 0.0,
    complete: bool = False,
    rising: Iterable[str] = (),
    falling: Iterable[str] = (),
    keep_rules: bool = False,
    columns: Mapping[str, str] | None = None,
    weight: str | None = None,
    group_by: str | None = None,
    skip_bad_rows: bool = False,
    validation: bool = True,
) -> LearnResult:
    """Learns rules from rows, after Wang and Mendel (1992). ``flagred learn`` does the same.

    Parameters
    ----------
    model
        The variables and terms. Its rules are replaced; its numbers are kept.
    data
        A frame, or a mapping of columns, with a column for each input and the output.
    resolve
        How rows of one combination of terms determine the consequent: the row with the highest degree, the consequent with
        the highest sum of degrees, or the mean of the rows.
    min_support
        The minimum number of rows of a rule.
    min_degree
        The minimum confidence of a rule.
    complete
        Add rules for combinations of terms without rows, each from the nearest combination with rows.
    rising, falling
        Inputs whose increase must not lower the output, and inputs whose increase must not raise it.
    keep_rules
        Add the learned rules to those of the model.
    columns
        The names of columns that differ from those of their variables: ``{"risk": "failed"}``.
    weight
        The column with the weights of the rows.
    group_by
        In cross-validation, hold out all rows with the same value of this column together.
    skip_bad_rows
        Skip rows that cannot be used, and list the reasons in ``refused``, instead of raising an error.
    validation
        Whether to compute the cross-validation error.

    Raises
    ------
    DataError
        A column is missing, or rows cannot be used.

    Examples
    --------
    >>> import flagred
    >>> fan = (
    ...     flagred.Model("fan")
    ...     .input("heat", range=(0, 40), partition=["cool", "hot"])
    ...     .output("speed", range=(0, 9), partition=["slow", "fast"])
    ... )
    >>> learned = flagred.learn(fan, {"heat": [5, 12, 36], "speed": [0, 2, 9]}, validation=False)
    >>> [rule.text for rule in learned.model.rules]
    ['IF heat IS cool THEN speed IS slow', 'IF heat IS hot THEN speed IS fast']
    """
    options = {
        "resolve": resolve,
        "min_support": min_support,
        "min_degree": min_degree,
        "complete": complete,
        "rising": names_of(rising),
        "falling": names_of(falling),
        "keep_rules": keep_rules,
        "validation": validation,
    }
    found = _learn(model, _rows(model, data, columns, weight, group_by, skip_bad_rows), whole_numbers(options))
    errors = found.pop("validation")
    return LearnResult(
        model=_read(found.pop("model"), "<model>"), validation=None if errors is None else Errors(**errors), **found
    )


def tune(
    model: Model,
    data: Any,
    *,
    loss: Literal["squared", "log", "ranking"] = "squared",
    only: Iterable[str] = (),
    fix: Iterable[str] = (),
    weights: bool = False,
    min_distance: float = 0.01,
    rising: Iterable[str] = (),
    falling: Iterable[str] = (),
    beyond_range: bool = False,
    digits: int | None = 3,
    starts: int = 1,
    iterations: int = 100,
    seed: int = 0,
    columns: Mapping[str, str] | None = None,
    weight: str | None = None,
    group_by: str | None = None,
    folds: int | None = None,
    skip_bad_rows: bool = False,
    threads: int | None = None,
) -> TuneResult:
    """Tunes the numbers of a rule set on rows; its rules do not change. ``flagred tune`` does the same.

    Parameters
    ----------
    model
        The rule set to start from. It does not change.
    data, columns, weight, group_by, skip_bad_rows, rising, falling
        As for :func:`learn`.
    loss
        ``squared`` errors; ``log`` and ``ranking`` for an output of 0 and 1: the mean of -ln p, and 1 minus the area under
        the ROC curve.
    only, fix
        The only variables, or terms as ``variable.term``, that may change; and those that must not change.
    weights
        Whether the weights of the rules may change.
    min_distance
        The minimum distance between neighbouring peaks, as a share of the range.
    beyond_range
        Whether constants may leave the range of the output, by at most its width.
    digits
        The significant digits of changed numbers; None keeps all.
    starts
        The number of starts of the search: first at the model, then at random points around it.
    iterations
        The maximum number of iterations of a start.
    seed
        The random seed (starting points, folds).
    folds
        The number of folds of a cross-validation; by default none is done.
    threads
        The number of threads; by default the number of cores.

    Raises
    ------
    DataError
        A column is missing, rows cannot be used, or no number may change.
    RuleSetError
        The rule set cannot be used.
    TuneInterrupted
        Ctrl-C ended the search before its next step; ``best`` of the exception is the best result so far. After a
        second Ctrl-C, KeyboardInterrupt is raised without waiting for that step.

    Examples
    --------
    >>> import flagred
    >>> fan = (
    ...     flagred.Model("fan")
    ...     .input("heat", range=(0, 40), partition={"cool": 5, "hot": 35})
    ...     .output("speed", range=(0, 10), terms={"slow": {"singleton": 2}, "fast": {"singleton": 8}})
    ...     .rule("IF heat IS cool THEN speed IS slow", "IF heat IS hot THEN speed IS fast")
    ... )
    >>> heat = list(range(41))
    >>> speed = [2 + 6 * min(max((value - 20) / 10, 0), 1) for value in heat]
    >>> tuned = flagred.tune(fan, {"heat": heat, "speed": speed})
    >>> [(one.of, one.name, one.after) for one in tuned.moved]
    [('heat.cool', 'peak', 20.0), ('heat.hot', 'peak', 30.0)]
    """
    options = {
        "loss": loss,
        "only": names_of(only),
        "fix": names_of(fix),
        "weights": weights,
        "min_distance": min_distance,
        "rising": names_of(rising),
        "falling": names_of(falling),
        "beyond_range": beyond_range,
        "digits": digits,
        "starts": starts,
        "iterations": iterations,
        "seed": seed,
        "folds": folds,
    }
    rows = _rows(model, data, columns, weight, group_by, skip_bad_rows)
    found, was_interrupted = _tune(model, rows, whole_numbers(options), threads)
    moved = [ChangedNumber(*one) for one in found.pop("moved")]
    worth = found.pop("validation")
    if worth is not None:
        folds = worth.pop("folds")
        worth = TuneValidation(folds=folds, **{name: Figure(*figure) for name, figure in worth.items()})
    tuned = TuneResult(model=_read(found.pop("model"), "<model>"), moved=moved, validation=worth, **found)
    if was_interrupted:
        raise TuneInterrupted(tuned)
    return tuned


def _rows(
    model: Model,
    data: Any,
    columns: Mapping[str, str] | None,
    weight: str | None,
    group_by: str | None,
    skip_bad_rows: bool,
) -> dict[str, Any]:
    """The columns in the form that the native half requires."""
    names = model._measured_names()
    renamed = dict(columns or {})
    for name in renamed:
        if name not in names:
            raise DataError(f"`columns` names `{name}`, which is not a variable of the rule set")
    data = table_of(data)
    found = [array(column_of(data, renamed.get(name, name))) for name in names]
    weights = None if weight is None else array(column_of(data, weight))
    groups = None if group_by is None else groups_of(data, group_by)
    same_length([*found, *([] if weights is None else [weights]), *([] if groups is None else [groups])])
    return {"columns": found, "weights": weights, "groups": groups, "skip_bad_rows": skip_bad_rows}
