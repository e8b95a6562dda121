// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/window/problem.hpp"

namespace fairlead::window {

struct LmOptions {
    int max_iterations = 50;
    double initial_damping = 1e-4;  ///< lambda of H + lambda diag(H)
    double tolerance = 1e-9;        ///< stops when the predicted decrease of E is below tolerance * max(1, E)
};

struct LmSummary {
    double initial_cost = 0.0;  ///< E before
    double cost = 0.0;          ///< E after
    int iterations = 0;         ///< linear systems solved
    bool converged = false;
    bool ok = false;  ///< finite, no singular state
};

/// Levenberg-Marquardt on landmarks and states together, states eliminated. Steps are accepted on E itself; gain ratio
/// = actual / predicted decrease with predicted = 1/2 d^T (lambda D d - g) (Madsen, Nielsen, Tingleff 2004, eq.
/// (3.14)); damping by Nielsen's rule (eq. (2.21)). On return the problem is linearised at its final estimate.
LmSummary levenberg_marquardt(Problem& problem, const LmOptions& options, Workspace& workspace) noexcept;

}  // namespace fairlead::window
