# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What this machine, or this target, cannot render."""


class RenderError(RuntimeError):
    """One line: what is missing, and what would help."""
