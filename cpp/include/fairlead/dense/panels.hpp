// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fairlead::dense {

/// A matrix in panels of eight rows, each column after column, so that products read memory in order. The last panel is
/// filled up with zeros.
class Panels {
  public:
    static constexpr int kRows = 8;

    Panels(int rows, int columns)
        : columns_(columns), values_(static_cast<std::size_t>((rows + kRows - 1) / kRows * kRows * columns), 0.0) {}

    [[nodiscard]] double* at(int row, int column) noexcept {
        return values_.data() + (static_cast<std::ptrdiff_t>(row / kRows) * columns_ + column) * kRows + row % kRows;
    }
    [[nodiscard]] int columns() const noexcept { return columns_; }
    void clear() noexcept { std::fill(values_.begin(), values_.end(), 0.0); }

  private:
    int columns_;
    std::vector<double> values_;
};

}  // namespace fairlead::dense
