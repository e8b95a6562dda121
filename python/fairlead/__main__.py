# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`python -m fairlead`."""

import sys

from fairlead.cli import main

sys.exit(main())
