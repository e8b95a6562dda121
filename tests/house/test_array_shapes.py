# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The annotated array shapes are really verified while tests run."""

import numpy as np
import pytest


def test_a_wrong_shape_is_refused_while_tests_run() -> None:
    import jaxtyping

    from fairlead.geometry import exp_se3

    assert np.allclose(exp_se3(np.zeros(6)), np.eye(4))
    with pytest.raises(jaxtyping.TypeCheckError):
        exp_se3(np.zeros(5))
