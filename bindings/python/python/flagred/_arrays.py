"""Values as NumPy arrays of float64 in which NaN is unknown."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import DataError


def array(value: Any) -> NDArray[np.float64]:
    """Converts a value of any kind to an array of float64; masked values, null and None become NaN."""
    if isinstance(value, np.ma.MaskedArray):
        filled: NDArray[np.float64] = np.ma.filled(value.astype(np.float64), np.nan)
        return filled
    try:
        if type(value).__module__.startswith("pandas.") and hasattr(value, "to_numpy"):
            # pandas has its own types, with null as a value.
            value = value.to_numpy(dtype=np.float64, na_value=np.nan)
        found = np.asarray(value)
        if found.dtype.kind not in "biufO":
            what = "text" if found.dtype.kind in "UST" else f"an array of {found.dtype}"
            raise DataError(f"{what} is not a number\n  help: convert it to numbers first")
        # The native half reads only aligned numbers.
        return np.require(found.astype(np.float64, copy=False), requirements="A")
    except DataError:
        raise
    except (TypeError, ValueError) as error:
        raise DataError(f"an array of objects contains a value that is not a number: {error}") from None


def alike(values: list[Any]) -> list[NDArray[np.float64]]:
    """Converts values to contiguous arrays of one shape."""
    arrays = [array(value) for value in values]
    try:
        arrays = list(np.broadcast_arrays(*arrays))
    except ValueError:
        shapes = ", ".join(str(one.shape) for one in arrays)
        raise DataError(f"arrays of the shapes {shapes} cannot be broadcast together") from None
    # Not `ascontiguousarray`, which would add an axis to a number.
    return [np.asarray(one, dtype=np.float64, order="C") for one in arrays]


def columns(value: Any, inputs: int) -> list[NDArray[np.float64]] | None:
    """The columns of a matrix; None for anything else."""
    matrix = array(value)
    if matrix.ndim != 2:
        return None
    if matrix.shape[1] != inputs:
        raise DataError(f"the matrix has {matrix.shape[1]} columns, but the model has {inputs} inputs")
    return [matrix[:, column] for column in range(inputs)]
