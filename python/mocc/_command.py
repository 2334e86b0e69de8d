"""The command `mocc`."""

import signal
import sys

from mocc import _mocc
from mocc._fmu import offer_runtime


def main() -> int:
    """Runs the command line of this process; returns its exit status."""
    arguments = ["mocc", *sys.argv[1:]]
    offer_runtime()
    if arguments[1:2] == ["sweep"] and any(a.split("=")[0] == "--cluster" for a in arguments):
        from mocc._cluster_command import sweep

        return sweep(arguments)
    # Ctrl-C ends the process, or the run if the command takes care of it; Python has no part in that.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _mocc.main(arguments)


if __name__ == "__main__":
    sys.exit(main())
