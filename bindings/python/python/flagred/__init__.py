"""Fuzzy rule sets, exact and fast; and the risk of a multirotor's loss of control, from a flight log.

>>> import flagred
>>> fan = flagred.loads('''
... fuzzy: 1
... name: fan
... inputs: {temperature: {range: [0, 40], unit: °C, partition: [cold, hot]}}
... outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
... rules: [IF temperature IS cold THEN speed IS slow, IF temperature IS hot THEN speed IS fast]
... ''')
>>> fan(20)
4.5

Models are called like functions: :func:`load`, :func:`loads`, :class:`Model`. Logs are assessed by :func:`assess`, or
sample by sample by a :class:`Monitor`. :func:`learn`, :func:`tune`, :func:`identify`, :func:`simplify` and
:func:`c_means` use data, :func:`evaluate` measures how well risks predict. ``flagred.types`` contains the types of
results, ``flagred.sklearn`` estimators, ``flagred.testing`` helpers for tests, and ``flagred.fleet`` functions for many
logs.
"""

from . import types
from ._clusters import c_means
from ._core import VERSION as __version__, Profile
from ._errors import DataError, FlagredError, LogError, RuleSetError
from ._flight import assess, read_log
from ._identify import identify
from ._learning import TuneInterrupted, learn, tune
from ._model import Model, load, loads
from ._monitor import Monitor
from ._simplify import simplify
from .evaluation import evaluate

__all__ = [
    "DataError",
    "FlagredError",
    "LogError",
    "Model",
    "Monitor",
    "Profile",
    "RuleSetError",
    "TuneInterrupted",
    "__version__",
    "assess",
    "c_means",
    "evaluate",
    "identify",
    "learn",
    "load",
    "loads",
    "read_log",
    "simplify",
    "tune",
    "types",
]
