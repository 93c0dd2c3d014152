"""Permutation tests of many hypotheses at once: the days of each vehicle are shuffled, and the highest score of all is
compared."""

from __future__ import annotations

import numpy as np

from .history import MEASURES, Reals

__all__ = ["Sum", "p_values", "shuffled", "student"]


class Sum:
    """The statistic of a change over its vehicles, for the data and each shuffling."""

    def __init__(self, rows: int, vehicles: int) -> None:
        # Limits the score of each vehicle, because a large change of one or two vehicles is not a change of all of them.
        self._most = 3.0 if vehicles == 2 else 2.5
        self._rise = np.zeros((rows, len(MEASURES)))
        self._vehicles = np.zeros(len(MEASURES))
        self._pooled = np.zeros((2, len(MEASURES)))
        self._signs: list[Reals] = []

    def add(self, before: Reals, values: Reals, rows: int) -> None:
        """Adds a vehicle: its values, the number of rows before the change, and the sums of its centred values in these rows."""
        variance = rows * (len(values) - rows) / len(values) * values.var(axis=0, ddof=1)
        varies = variance > 1e-12
        rise = np.divide(-before, np.sqrt(variance), out=np.zeros_like(before), where=varies)
        self._rise += np.clip(rise, -self._most, self._most)
        self._vehicles += varies
        self._pooled += [-before[0], variance]
        self._signs.append(np.sign(rise[0]))

    def scores(self) -> Reals:
        """The mean rise of the vehicles divided by its standard error, as an absolute value."""
        scores: Reals = np.abs(self._rise) / np.sqrt(np.maximum(self._vehicles, 1))
        return scores

    def agreement(self, measure: int) -> float:
        """The share of vehicles whose risk changed in the same direction as the mean."""
        signs = np.array(self._signs)[:, measure]
        return float((signs[signs != 0] == np.sign(self._rise[0, measure])).mean())

    def fit(self) -> float:
        """How well the change explains the days, to choose between neighbouring weeks."""
        rise, variance = self._pooled
        return float((rise**2 / np.maximum(variance, 1e-12)).max())


def shuffled(values: Reals, shuffles: int, chance: np.random.Generator) -> Reals:
    """Running sums of the centred values: in their order, and then shuffled this many times."""
    order = np.tile(np.arange(len(values)), (shuffles + 1, 1))
    order[1:] = chance.permuted(order[1:], axis=1)
    sums: Reals = np.cumsum((values - values.mean(axis=0))[order], axis=1)
    return sums


def p_values(scores: Reals) -> Reals:
    """P values for all tests together, after Westfall and Young: how often the highest score of all tests is as high by chance.
    Scores are indexed by test, shuffling (the first is the data) and measure."""
    highest = scores[:, 1:].max(axis=(0, 2))
    p: Reals = (1 + (highest[:, None, None] >= scores[:, 0]).sum(axis=0)) / (1 + len(highest))
    return p


def student(freedom: int) -> float:
    """The 97.5 % quantile of Student's t, after Cornish and Fisher."""
    return 1.959964 + 2.372271 / freedom + 2.822553 / freedom**2 + 2.555497 / freedom**3
