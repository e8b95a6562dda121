// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/dense/panels.hpp"
#include "fairlead/geometry/types.hpp"

namespace fairlead::dense {

/// The columns of a rank update S -= Y Y^T, gathered a few at a time: where most of the time of a solve goes. The
/// default build stays portable and is as fast as one made for the machine.
class RankUpdate {
  public:
    RankUpdate(int rows, int capacity) : rows_(rows), Y_(rows, capacity) {}

    [[nodiscard]] int room() const noexcept { return Y_.columns() - columns_; }

    /// Adds to a row, in the columns that come after those already taken.
    template <typename Row>
    void add(int row, const Eigen::MatrixBase<Row>& values) noexcept {
        double* element = Y_.at(row, columns_);
        for (Eigen::Index c = 0; c < values.size(); ++c, element += Panels::kRows) *element += values[c];
    }
    void take(int columns) noexcept { columns_ += columns; }

    /// S -= Y Y^T in the lower triangle; Y is then zero and empty.
    void subtract_from(MatX& S) noexcept;

  private:
    int rows_;
    int columns_ = 0;
    Panels Y_;
};

}  // namespace fairlead::dense
