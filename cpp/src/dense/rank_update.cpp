// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/dense/rank_update.hpp"

#include <algorithm>

#if defined(__x86_64__)
#define FAIRLEAD_AVX2 __attribute__((target("avx2,fma")))
#endif

namespace fairlead::dense {
namespace {

constexpr int kPanel = RankUpdate::kPanel;
constexpr int kColumns = 4;  // of S in one tile
using Four [[gnu::vector_size(32), gnu::aligned(8)]] = double;

/// One panel of eight rows of Y, and another one moved to the first of the four rows that make the tile's columns.
struct Strip {
    const double* rows;
    const double* columns;
    int depth;  ///< columns of Y
};

/// tile -= Y_rows Y_columns^T, Fours * 4 rows by 4 columns, `stride` from one column of the tile to the next. The sums
/// stay in registers.
template <int Fours>
[[gnu::always_inline]] inline void subtract(const Strip& strip, double* tile, std::ptrdiff_t stride) noexcept {
    Four sum[kColumns][Fours];
#pragma GCC unroll 8
    for (int i = 0; i < kColumns * Fours; ++i) sum[i / Fours][i % Fours] = Four{};
    const double* a = strip.rows;
    const double* b = strip.columns;
    for (int k = 0; k < strip.depth; ++k, a += kPanel, b += kPanel) {
#pragma GCC unroll 8
        for (int i = 0; i < kColumns * Fours; ++i)
            sum[i / Fours][i % Fours] += *reinterpret_cast<const Four*>(a + 4 * (i % Fours)) * b[i / Fours];
    }
#pragma GCC unroll 8
    for (int i = 0; i < kColumns * Fours; ++i)
        *reinterpret_cast<Four*>(tile + stride * (i / Fours) + 4 * (i % Fours)) -= sum[i / Fours][i % Fours];
}

void subtract_portable(const Strip& strip, double* tile, std::ptrdiff_t stride) noexcept {
    subtract<1>(strip, tile, stride);
    subtract<1>({strip.rows + 4, strip.columns, strip.depth}, tile + 4, stride);
}

#if defined(FAIRLEAD_AVX2)
FAIRLEAD_AVX2 void subtract_avx2(const Strip& strip, double* tile, std::ptrdiff_t stride) noexcept {
    subtract<2>(strip, tile, stride);
}

const auto subtract_tile =
    __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? subtract_avx2 : subtract_portable;
#else
constexpr auto subtract_tile = subtract_portable;
#endif

}  // namespace

RankUpdate::RankUpdate(int rows, int capacity)
    : rows_(rows),
      capacity_(capacity),
      Y_(static_cast<std::size_t>((rows + kPanel - 1) / kPanel * kPanel) * static_cast<std::size_t>(capacity), 0.0) {}

void RankUpdate::subtract_from(MatX& S) noexcept {
    for (int i = 0; i < rows_; i += kPanel) {
        const double* panel = Y_.data() + static_cast<std::ptrdiff_t>(i) * capacity_;
        for (int j = 0; j <= i + kPanel - kColumns && j < rows_; j += kColumns) {
            const double* columns =
                Y_.data() + static_cast<std::ptrdiff_t>(j / kPanel * kPanel) * capacity_ + j % kPanel;
            const Strip strip{panel, columns, columns_};
            if (i + kPanel <= rows_ && j + kColumns <= rows_) {
                subtract_tile(strip, &S(i, j), S.outerStride());
                continue;
            }
            double tile[kColumns * kPanel] = {};
            subtract_tile(strip, tile, kPanel);
            for (int c = 0; c < std::min(kColumns, rows_ - j); ++c)
                for (int r = 0; r < std::min(kPanel, rows_ - i); ++r) S(i + r, j + c) += tile[kPanel * c + r];
        }
    }
    for (int i = 0; i < rows_; i += kPanel)
        std::fill_n(Y_.begin() + static_cast<std::ptrdiff_t>(i) * capacity_, kPanel * columns_, 0.0);
    columns_ = 0;
}

}  // namespace fairlead::dense
