"""`python -m mocc` is the command `mocc`."""

import sys

from mocc._command import main

sys.exit(main())
