// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/dense/cholesky.hpp"

#include <algorithm>
#include <cmath>

#include "tile.hpp"

namespace fairlead::dense {
namespace {

constexpr int kRows = Panels::kRows;
using Column = Eigen::Map<Eigen::Matrix<double, kRows, 1>>;
using Corner = Eigen::Matrix<double, kColumns, kColumns>;  ///< of L where four columns begin; diagonal inverted

/// L of the panel that holds the four rows from `first` on of its tile, and their corner; false if a pivot is not
/// positive.
bool factor_tile(double* tile, int first, Corner& corner) noexcept {
    for (int c = 0; c < kColumns; ++c) {
        Column column(tile + kRows * c);
        const double pivot = column[first + c];
        if (!(pivot > 0.0)) return false;
        corner(c, c) = 1.0 / std::sqrt(pivot);
        column *= corner(c, c);
        for (int d = c + 1; d < kColumns; ++d) {
            corner(d, c) = column[first + d];
            Column(tile + kRows * d) -= corner(d, c) * column;
        }
    }
    return true;
}

/// The same of a panel further down: tile <- tile L^-T.
void divide_tile(double* tile, const Corner& corner) noexcept {
    for (int c = 0; c < kColumns; ++c) {
        Column column(tile + kRows * c);
        column *= corner(c, c);
        for (int d = c + 1; d < kColumns; ++d) Column(tile + kRows * d) -= corner(d, c) * column;
    }
}

/// A panel's part of a column; the last panel has fewer rows.
void copy(const double* from, double* to, int rows) noexcept {
    if (rows < kRows)
        std::copy_n(from, rows, to);
    else
        Column{to} = Eigen::Map<const Eigen::Matrix<double, kRows, 1>>(from);
}

}  // namespace

Cholesky::Cholesky(int rows) : rows_(rows), panels_(rows, (rows + kColumns - 1) / kColumns * kColumns) {
    L_.setZero(rows, rows);
}

bool Cholesky::factor_columns(int j) noexcept {
    const int top = j / kRows * kRows;
    Corner corner;
    for (int i = top; i < rows_; i += kRows) {
        double* tile = panels_.at(i, j);
        subtract_tile({panels_.at(i, 0), panels_.at(j, 0), j}, tile, kRows);
        if (i > top)
            divide_tile(tile, corner);
        else if (!factor_tile(tile, j - top, corner))
            return false;
    }
    return true;
}

bool Cholesky::factor(const MatX& A) noexcept {
    for (int r = 0; r < rows_; r += kRows)
        for (int c = 0; c < std::min(r + kRows, rows_); ++c) copy(&A(r, c), panels_.at(r, c), rows_ - r);
    for (int c = rows_; c < panels_.columns(); ++c) *panels_.at(c, c) = 1.0;
    for (int j = 0; j < rows_; j += kColumns)
        if (!factor_columns(j)) return false;
    for (int r = 0; r < rows_; r += kRows)
        for (int c = 0; c < std::min(r + kRows, rows_); ++c) copy(panels_.at(r, c), &L_(r, c), rows_ - r);
    return true;
}

}  // namespace fairlead::dense
