"""The command `mocc`."""

import signal
import sys

from mocc import _mocc


def main() -> int:
    """Runs the command line of this process; returns its exit status."""
    # Ctrl-C ends the process, or the run if the command takes care of it; Python has no part in that.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _mocc.main(["mocc", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
