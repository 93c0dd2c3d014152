"""Functions that use data: rules and terms from rows, tuned numbers, shorter rule sets."""

from ._clusters import c_means
from ._identify import identify
from ._learning import TuneInterrupted, learn, tune
from ._simplify import simplify

__all__ = ["TuneInterrupted", "c_means", "identify", "learn", "simplify", "tune"]
