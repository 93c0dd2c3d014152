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
sample by sample by a :class:`Monitor`, with a shipped profile or your own: ``help("flagred.Profile")``.

``learn``, ``tune``, ``identify``, ``simplify`` and ``c_means`` use data: ``help("flagred.learning")``. ``evaluate``
measures how well risks predict: ``help("flagred.evaluation")``. Each error is a ``FlagredError``:
``help("flagred.errors")``. ``flagred.types`` contains the types of results, ``flagred.sklearn`` estimators,
``flagred.testing`` helpers for tests, and ``flagred.fleet`` functions for many logs.
"""

from . import types
from ._clusters import c_means as c_means
from ._core import VERSION as __version__, Profile as Profile
from ._flight import assess, read_log
from ._identify import identify as identify
from ._learning import TuneInterrupted as TuneInterrupted, learn as learn, tune as tune
from ._model import Model, load, loads
from ._monitor import Monitor
from ._simplify import simplify as simplify
from .errors import (
    DataError as DataError,
    FlagredError as FlagredError,
    LogError as LogError,
    RuleSetError as RuleSetError,
)
from .evaluation import evaluate as evaluate

# The names that `help(flagred)` shows. The modules that it mentions describe the other names.
__all__ = ["Model", "Monitor", "__version__", "assess", "load", "loads", "read_log", "types"]
