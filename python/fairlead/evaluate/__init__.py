# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""(truth, estimates) -> metrics, tables, figures, one self-contained report: docs/metrics.md."""

from fairlead.evaluate.catalogue import METRICS, metric_values
from fairlead.evaluate.document import evaluation_to_json
from fairlead.evaluate.evaluation import Evaluation, evaluate
from fairlead.evaluate.report import ReportHeader, render_report, write_report
from fairlead.evaluate.run_folder import evaluate_run, evaluate_runs

__all__ = [
    "METRICS",
    "Evaluation",
    "ReportHeader",
    "evaluate",
    "evaluate_run",
    "evaluate_runs",
    "evaluation_to_json",
    "metric_values",
    "render_report",
    "write_report",
]
