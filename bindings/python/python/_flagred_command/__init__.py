"""The command `flagred` of the wheel.

It loads only the native module. The package `flagred` imports NumPy, which the command does not need and which would more
than double its start-up time.
"""

import signal
import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from os.path import dirname, join


def main() -> int:
    """Runs the command line of this process and returns its exit code."""
    # Python's handler sets a flag that only Python code reads. With the default handler, Ctrl-C ends the command like any
    # program; commands that finish their work first, such as `flagred watch`, set their own handler.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    spec = PathFinder.find_spec("flagred._core", [join(dirname(dirname(__file__)), "flagred")])
    if spec is None or spec.loader is None:
        raise ImportError("the native module of the package `flagred` is missing: install the package again")
    core = module_from_spec(spec)
    spec.loader.exec_module(core)
    code: int = core._command(sys.argv)
    return code
