// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/dense/rank_update.hpp"

#include <algorithm>

#include "tile.hpp"

namespace fairlead::dense {

constexpr int kRows = Panels::kRows;

void RankUpdate::subtract_from(MatX& S) noexcept {
    for (int i = 0; i < rows_; i += kRows) {
        for (int j = 0; j <= i + kRows - kColumns && j < rows_; j += kColumns) {
            const Strip strip{Y_.at(i, 0), Y_.at(j, 0), columns_};
            if (i + kRows <= rows_ && j + kColumns <= rows_) {
                subtract_tile(strip, &S(i, j), S.outerStride());
                continue;
            }
            double tile[kColumns * kRows] = {};
            subtract_tile(strip, tile, kRows);
            for (int c = 0; c < std::min(kColumns, rows_ - j); ++c)
                for (int r = 0; r < std::min(kRows, rows_ - i); ++r) S(i + r, j + c) += tile[kRows * c + r];
        }
    }
    for (int i = 0; i < rows_; i += kRows) std::fill_n(Y_.at(i, 0), kRows * columns_, 0.0);
    columns_ = 0;
}

}  // namespace fairlead::dense
