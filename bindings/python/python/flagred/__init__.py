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
    Profile,
    Share,
    Table,
    Update,
)
from ._data import (
    Cause,
    Event,
    Finding,
    Gap,
    Geometry,
    Interval,
    Intervals,
    LeftOut,
    Motor,
    MotorFinding,
    Parameter,
    Peak,
    Range,
    Report,
    Summary,
    Vehicle,
)
from ._errors import DataError, Diagnostic, FlagredError, LogError, RuleSetError
from ._flight import Assessment, Flight, Signal, assess, read_log
from ._identify import Identified, IdentifyValidation, Step, identify
from ._learning import Errors, Figure, Learned, Moved, Tuned, TuneInterrupted, TuneValidation, learn, tune
from ._model import Model, load, loads
from ._monitor import Followed, Monitor
from ._picture import Picture
from ._simplify import Difference, Simplified, simplify
from .evaluation import Evaluation, evaluate

__all__ = [
    "Assessment",
    "Cause",
    "DataError",
    "DecisionMap",
    "Diagnostic",
    "Difference",
    "Errors",
    "Evaluation",
    "Event",
    "ExplainedInput",
    "ExplainedOutput",
    "Explanation",
    "Figure",
    "Finding",
    "FiredRule",
    "FlagredError",
    "Flight",
    "Followed",
    "Gap",
    "Geometry",
    "Identified",
    "IdentifyValidation",
    "Interval",
    "Intervals",
    "Learned",
    "LeftOut",
    "LogError",
    "Model",
    "Monitor",
    "Motor",
    "MotorFinding",
    "Moved",
    "Outcome",
    "Outcomes",
    "Parameter",
    "Peak",
    "Picture",
    "Profile",
    "Range",
    "Report",
    "RuleSetError",
    "Share",
    "Signal",
    "Simplified",
    "Step",
    "Summary",
    "Table",
    "TuneInterrupted",
    "TuneValidation",
    "Tuned",
    "Update",
    "Vehicle",
    "__version__",
    "assess",
    "evaluate",
    "identify",
    "learn",
    "load",
    "loads",
    "read_log",
    "simplify",
    "tune",
]
