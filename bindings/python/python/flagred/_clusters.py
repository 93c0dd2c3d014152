"""Fuzzy c-means: groups of rows, and terms of an input from data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import array
from ._core import _c_means
from .errors import DataError
from ._tables import whole_numbers

__all__ = ["Clusters", "c_means"]


class Clusters(NamedTuple):
    """Clusters of rows, in ascending order of their centers."""

    centers: NDArray[np.float64]
    """The center of each cluster: an array for values, a matrix with a row for each cluster for a matrix."""
    degrees: NDArray[np.float64]
    """The degree of each row in each cluster. The degrees of a row sum to 1."""
    loss: float
    """The sum of squared distances to the centers, weighted by the degrees to the power of the fuzzifier."""
    iterations: int
    """The number of iterations of the best start."""

    def partition(self, names: Sequence[str]) -> dict[str, float]:
        """The centers as the ``partition`` of an input: the peak of each term.

        Parameters
        ----------
        names
            The names of the terms, in ascending order of their peaks.
        """
        if self.centers.ndim != 1:
            raise DataError("terms describe one input, but these clusters have several columns")
        if len(names) != len(self.centers):
            raise DataError(f"there are {len(self.centers)} clusters but {len(names)} names")
        return {name: float(center) for name, center in zip(names, self.centers)}


def c_means(
    rows: ArrayLike,
    clusters: int,
    *,
    fuzzifier: float = 2.0,
    iterations: int = 300,
    starts: int = 5,
    seed: int = 0,
) -> Clusters:
    """Finds clusters of rows by fuzzy c-means (Bezdek 1981).

    Parameters
    ----------
    rows
        Values, or a matrix with a row for each point. Distances are not scaled: scale the columns if their units differ.
    clusters
        The number of clusters, at least 2.
    fuzzifier
        Above 1; the larger, the softer the clusters.
    iterations
        The maximum number of iterations of a start.
    starts
        The number of starts, each from different rows. The start with the lowest loss is the result.
    seed
        The random seed for choosing the rows from which the search starts.

    Raises
    ------
    DataError
        A value is unknown, or there are fewer different rows than clusters.

    Examples
    --------
    >>> import flagred
    >>> heat = [8, 9, 10, 19, 20, 21, 34, 35, 36]
    >>> found = flagred.c_means(heat, 3)
    >>> found.centers.round(1)
    array([ 9., 20., 35.])
    >>> fan = flagred.Model("fan").input("heat", range=(0, 40), partition=found.partition(["cool", "warm", "hot"]))
    """
    matrix = array(rows)
    if matrix.ndim not in (1, 2):
        raise DataError(f"rows must be an array or a matrix, but this array has {matrix.ndim} axes")
    whole_numbers({"clusters": clusters, "iterations": iterations, "starts": starts, "seed": seed})
    is_column = matrix.ndim == 1
    found = _c_means(matrix[:, None] if is_column else matrix, clusters, fuzzifier, iterations, starts, seed)
    centers, degrees, loss, done = found
    return Clusters(centers[:, 0] if is_column else centers, degrees, loss, done)
