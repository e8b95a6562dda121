// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/dense/cholesky.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <limits>
#include <random>

using namespace fairlead;

namespace {

MatX positive_definite(int rows, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const MatX B = MatX::NullaryExpr(rows, rows + 3, [&] { return normal(random); });
    return B * B.transpose();
}

}  // namespace

BOOST_AUTO_TEST_CASE(factors_and_solves_whatever_the_size) {
    for (const int rows : {1, 2, 3, 4, 5, 7, 8, 9, 12, 13, 31, 60, 61, 90}) {
        dense::Cholesky cholesky(rows);
        for (const unsigned seed : {1U, 2U}) {  // the second finds the first one's factor
            const MatX A = positive_definite(rows, seed);
            MatX lower = A.triangularView<Eigen::Lower>();  // what is above the diagonal is not read
            lower.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
            BOOST_TEST_REQUIRE(cholesky.factor(lower));
            const MatX L = cholesky.L();
            BOOST_TEST((L * L.transpose() - A).norm() < 1e-13 * A.norm());
            BOOST_TEST(std::abs(2.0 * cholesky.half_log_det() - std::log(A.determinant())) < 1e-8 * rows);
            MatX X = A.leftCols(std::min(rows, 2));
            cholesky.solve_in_place(X);
            BOOST_TEST((X - MatX::Identity(rows, X.cols())).norm() < 1e-6);
        }
    }
}

BOOST_AUTO_TEST_CASE(says_what_is_not_positive_definite) {
    for (const int rows : {1, 6, 8, 21, 60}) {
        dense::Cholesky cholesky(rows);
        for (const double pivot : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
            MatX A = MatX::Identity(rows, rows);
            A(rows - 1, rows - 1) = pivot;
            BOOST_TEST(!cholesky.factor(A));
        }
        BOOST_TEST(cholesky.factor(MatX::Identity(rows, rows)));
    }
}
