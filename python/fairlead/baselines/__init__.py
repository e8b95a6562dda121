# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What fairlead is compared with, behind the same protocol: EPnP per frame, and the published free window."""
