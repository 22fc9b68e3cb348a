"""``python -m raywright``."""

import sys

from .cli import main

sys.exit(main())
