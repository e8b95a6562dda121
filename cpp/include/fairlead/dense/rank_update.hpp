// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "fairlead/geometry/types.hpp"

namespace fairlead::dense {

/// The columns of a rank update S -= Y Y^T, gathered a few at a time: where most of the time of a solve goes.
///
/// Y is kept in panels of eight rows, column after column, so that the product reads memory in order. It uses AVX2
/// where the processor has it, which is asked at run time: the default build stays portable and is as fast as one made
/// for the machine.
class RankUpdate {
  public:
    static constexpr int kPanel = 8;

    RankUpdate(int rows, int capacity);

    [[nodiscard]] int room() const noexcept { return capacity_ - columns_; }

    /// Element of the column that comes `offset` after those already taken.
    double& at(int row, int offset) noexcept {
        const auto panel = static_cast<std::size_t>(row / kPanel);
        const auto column = static_cast<std::size_t>(columns_) + static_cast<std::size_t>(offset);
        return Y_[(panel * static_cast<std::size_t>(capacity_) + column) * kPanel +
                  static_cast<std::size_t>(row % kPanel)];
    }
    void take(int columns) noexcept { columns_ += columns; }

    /// S -= Y Y^T in the lower triangle; Y is then zero and empty.
    void subtract_from(MatX& S) noexcept;

  private:
    int rows_, capacity_;
    int columns_ = 0;
    std::vector<double> Y_;
};

}  // namespace fairlead::dense
