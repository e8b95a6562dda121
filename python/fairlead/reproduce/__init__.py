# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead reproduce`: the published experiments once more, theirs beside ours. docs/reproduce.md."""

from fairlead.reproduce.command import ReproduceSummary, reproduce

__all__ = ["ReproduceSummary", "reproduce"]
