"""Fuzzy rule sets, exact and fast; and from a flight log, how close a multirotor was to losing control.

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
"""

from ._core import (
    VERSION as __version__,
    DecisionMap,
    ExplainedInput,
    ExplainedOutput,
    Explanation,
    FiredRule,
    Outcome,
    Outcomes,
    Share,
    Table,
)
from ._errors import DataError, Diagnostic, FlagredError, LogError, RuleSetError
from ._model import Model, load, loads
from ._picture import Picture

__all__ = [
    "DataError",
    "DecisionMap",
    "Diagnostic",
    "ExplainedInput",
    "ExplainedOutput",
    "Explanation",
    "FiredRule",
    "FlagredError",
    "LogError",
    "Model",
    "Outcome",
    "Outcomes",
    "Picture",
    "RuleSetError",
    "Share",
    "Table",
    "__version__",
    "load",
    "loads",
]
