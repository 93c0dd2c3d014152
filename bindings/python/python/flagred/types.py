"""The types of the results of functions and methods of the package."""

from ._clusters import Clusters
from ._core import (
    DecisionMap,
    ExplainedInput,
    ExplainedOutput,
    Explanation,
    FiredRule,
    Outcome,
    Outcomes,
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
from ._edit import Operators, Output, Rule, Rules, Term, Variable, Variables
from ._errors import Diagnostic
from ._flight import Assessment, Flight, Signal, Signals
from ._identify import Identified, IdentifyValidation, Step
from ._learning import Errors, Figure, Learned, Moved, Tuned, TuneValidation
from ._monitor import Followed
from ._picture import Picture
from ._simplify import Difference, Simplified
from .evaluation import Evaluation

__all__ = [
    "Assessment",
    "Cause",
    "Clusters",
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
    "Motor",
    "MotorFinding",
    "Moved",
    "Operators",
    "Outcome",
    "Outcomes",
    "Output",
    "Parameter",
    "Peak",
    "Picture",
    "Range",
    "Report",
    "Rule",
    "Rules",
    "Share",
    "Signal",
    "Signals",
    "Simplified",
    "Step",
    "Summary",
    "Table",
    "Term",
    "TuneValidation",
    "Tuned",
    "Update",
    "Variable",
    "Variables",
    "Vehicle",
]
