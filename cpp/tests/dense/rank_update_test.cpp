// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/dense/rank_update.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <random>

using namespace fairlead;

BOOST_AUTO_TEST_CASE(subtracts_the_product_whatever_the_size) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (const int rows : {1, 3, 7, 8, 9, 12, 31, 60, 61}) {
        const int columns = 1 + rows % 13;
        dense::RankUpdate update(rows, columns + 2);
        MatX S = MatX::NullaryExpr(rows, rows, [&] { return normal(random); });
        MatX expected = S;
        for (int turn = 0; turn < 2; ++turn) {  // the second finds it empty again
            const MatX Y = MatX::NullaryExpr(rows, columns, [&] { return normal(random); });
            for (int r = 0; r < rows; ++r) update.add(r, Y.row(r));
            update.take(columns);
            BOOST_TEST(update.room() == 2);
            update.subtract_from(S);
            expected.triangularView<Eigen::Lower>() -= Y * Y.transpose();
        }
        const MatX difference = (S - expected).triangularView<Eigen::Lower>();
        BOOST_TEST(difference.cwiseAbs().maxCoeff() < 1e-12);
    }
}
