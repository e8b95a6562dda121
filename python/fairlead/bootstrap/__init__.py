# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A first target where there is none: from a few views of tags of known size, or of landmarks and one distance.

docs/your-own-target.md section 4.
"""

from fairlead.bootstrap.landmarks import bootstrap_landmarks
from fairlead.bootstrap.problem import BootstrapError, Bootstrapped
from fairlead.bootstrap.tags import bootstrap_tags

__all__ = ["BootstrapError", "Bootstrapped", "bootstrap_landmarks", "bootstrap_tags"]
