// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "fairlead/dense/panels.hpp"

namespace fairlead::dense {

/// One panel of rows, and another one moved to the first of the four rows that make the tile's columns.
struct Strip {
    const double* rows;
    const double* columns;
    int depth;
};

/// tile -= rows columns^T, eight rows by four columns, `stride` from one column of the tile to the next. It uses AVX2
/// where the processor has it, which is asked at run time.
using SubtractTile = void (*)(const Strip& strip, double* tile, std::ptrdiff_t stride) noexcept;
extern const SubtractTile subtract_tile;

inline constexpr int kColumns = 4;  ///< in one tile

}  // namespace fairlead::dense
