# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""(truth, estimates) -> metrics, tables, figures, one self-contained report: docs/metrics.md."""

from fairlead.evaluate.evaluation import Evaluation, evaluate

__all__ = ["Evaluation", "evaluate"]
