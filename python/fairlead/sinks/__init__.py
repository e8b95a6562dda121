# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Where estimates go: small types with `write(estimate)` and `close()`."""
