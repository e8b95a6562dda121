// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "tile.hpp"

#if defined(__x86_64__)
#define FAIRLEAD_AVX2 __attribute__((target("avx2,fma")))
#endif

namespace fairlead::dense {
namespace {

constexpr int kRows = Panels::kRows;
using Four [[gnu::vector_size(32), gnu::aligned(8)]] = double;

/// Fours * 4 rows of the tile. The sums stay in registers.
template <int Fours>
[[gnu::always_inline]] inline void subtract(const Strip& strip, double* tile, std::ptrdiff_t stride) noexcept {
    Four sum[kColumns][Fours];
#pragma GCC unroll 8
    for (int i = 0; i < kColumns * Fours; ++i) sum[i / Fours][i % Fours] = Four{};
    const double* a = strip.rows;
    const double* b = strip.columns;
    for (int k = 0; k < strip.depth; ++k, a += kRows, b += kRows) {
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
#endif

SubtractTile fastest() noexcept {
#if defined(FAIRLEAD_AVX2)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return subtract_avx2;
#endif
    return subtract_portable;
}

}  // namespace

const SubtractTile subtract_tile = fastest();

}  // namespace fairlead::dense
