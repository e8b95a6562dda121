// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/chain.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <random>

#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

/// Positions of a path seen through a linear camera that also depends on the shape: the chain, view by view, against
/// one dense least squares problem of all motions.
BOOST_AUTO_TEST_CASE(view_by_view_is_the_dense_problem_with_the_motions_eliminated) {
    const Scene scene = make_scene(5, 1, 0.0, 1.0, 1.0, 7);
    const Eigen::Index n = 15;
    const int axes = 3, states = 9, views = 4;
    const double dt = 0.4, q = 2.0;
    std::mt19937_64 random(8);
    std::normal_distribution<double> normal;

    motion::Chain chain({scene.X_told, window::Gauge::rigid}, axes);
    chain.set_model(scene.X_told);  // at the reference: u = 0, and the slice's frame is the model's
    MatX H = MatX::Zero(n + views * states, n + views * states);
    VecX g = VecX::Zero(n + views * states);
    // What the chain assumes of a motion that nobody has seen: read off before it has seen any.
    H.block(n, n, states, states) += chain.motion_information();
    for (int k = 0; k < views; ++k) {
        const Eigen::Index at = n + k * states;
        if (k > 0) {
            chain.predict(dt, q);
            chain.set_model(scene.X_told);
            const motion::StateSquare L = motion::noise_factor(dt, q, axes);
            const MatX W = (L * L.transpose()).inverse();
            MatX J(states, 2 * states);
            J << -motion::transition(dt, axes), motion::StateSquare::Identity(states, states);
            H.block(at - states, at - states, 2 * states, 2 * states) += J.transpose() * W * J;
        }
        MatX J = MatX::NullaryExpr(3, n + 3, [&] { return normal(random); });
        const Vec3 r(normal(random), normal(random), normal(random));
        motion::StateSquare C = motion::StateSquare::Zero(states, states);
        motion::State c = motion::State::Zero(states);
        MatX B = MatX::Zero(n, states);
        B.leftCols(3) = J.leftCols(n).transpose() * J.rightCols(3);
        C.topLeftCorner(3, 3) = J.rightCols(3).transpose() * J.rightCols(3);
        c.head(3) = J.rightCols(3).transpose() * r;
        const VecX b = J.leftCols(n).transpose() * r;
        chain.absorb(J.leftCols(n).transpose() * J.leftCols(n), B, C, b, c, motion::State::Zero(states));
        H.topLeftCorner(n, n) += J.leftCols(n).transpose() * J.leftCols(n);
        H.block(0, at, n, 3) += B.leftCols(3);
        H.block(at, 0, 3, n) += B.leftCols(3).transpose();
        H.block(at, at, 3, 3) += C.topLeftCorner(3, 3);
        g.head(n) += b;
        g.segment(at, 3) += c.head(3);
    }
    const Eigen::Index rest = views * states;
    const MatX gain = H.bottomRightCorner(rest, rest).ldlt().solve(H.bottomLeftCorner(rest, n));
    const MatX expected = H.topLeftCorner(n, n) - H.topRightCorner(n, rest) * gain;
    const VecX expected_eta = -(g.head(n) - gain.transpose() * g.tail(rest));
    MatX Lambda;
    VecX eta;
    chain.marginal(Lambda, eta);
    BOOST_TEST((Lambda - expected).norm() < 1e-5 * expected.norm());
    BOOST_TEST((eta - expected_eta).norm() < 1e-5 * expected_eta.norm());
}

/// What the views before a motion and those after it say of it, added up, against one dense problem.
BOOST_AUTO_TEST_CASE(forwards_and_backwards_meet_in_the_dense_problem) {
    const Scene scene = make_scene(5, 1, 0.0, 1.0, 1.0, 7);
    const Eigen::Index n = 15, states = 3;
    const int views = 4, middle = 2;
    const double dt = 0.4, q = 2.0;
    std::mt19937_64 random(9);
    std::normal_distribution<double> normal;
    motion::Chain before({scene.X_told, window::Gauge::rigid}, 1), after({scene.X_told, window::Gauge::rigid}, 1);
    MatX H = MatX::Zero(n + views * states, n + views * states);
    H.block(n, n, states, states) += before.motion_information();
    std::vector<MatX> J;
    for (int k = 0; k < views; ++k) {
        const Eigen::Index at = n + k * states;
        J.emplace_back(MatX::NullaryExpr(1, n + 1, [&] { return normal(random); }));
        H.topLeftCorner(n, n) += J.back().leftCols(n).transpose() * J.back().leftCols(n);
        H.block(at, 0, 1, n) += J.back()(0, n) * J.back().leftCols(n);
        H(at, at) += J.back()(0, n) * J.back()(0, n);
        if (k == 0) continue;
        const motion::StateSquare L = motion::noise_factor(dt, q, 1);
        MatX F(states, 2 * states);
        F << -motion::transition(dt, 1), motion::StateSquare::Identity(states, states);
        H.block(at - states, at - states, 2 * states, 2 * states) +=
            F.transpose() * MatX(L * L.transpose()).inverse() * F;
    }
    const auto absorb = [&](motion::Chain& chain, int k) {
        const auto& row = J[static_cast<std::size_t>(k)];
        MatX B = MatX::Zero(n, states);
        B.col(0) = row(0, n) * row.leftCols(n).transpose();
        motion::StateSquare C = motion::StateSquare::Zero(states, states);
        C(0, 0) = row(0, n) * row(0, n);
        const motion::State zero = motion::State::Zero(states);
        chain.absorb(row.leftCols(n).transpose() * row.leftCols(n), B, C, VecX::Zero(n), zero, zero);
    };
    after.clear();
    for (motion::Chain* chain : {&before, &after}) chain->set_model(scene.X_told);
    for (int k = 0; k <= middle; ++k) {
        if (k > 0) before.predict(dt, q);
        absorb(before, k);
    }
    for (int k = views - 1; k > middle; --k) {
        absorb(after, k);
        after.retrodict(dt, q);
    }
    // Of the dense problem, all motions but the middle one eliminated, and the views that are not shared.
    MatX full = H.selfadjointView<Eigen::Lower>();
    std::vector<Eigen::Index> keep, rest;
    for (Eigen::Index i = 0; i < full.rows(); ++i) {
        const Eigen::Index k = i < n ? middle : (i - n) / states;
        (k == middle ? keep : rest).push_back(i);
    }
    const MatX gain = MatX(full(rest, rest)).ldlt().solve(MatX(full(rest, keep)));
    const MatX expected = full(keep, keep) - full(keep, rest) * gain;
    const MatX coupling = before.coupling() + after.coupling();
    const MatX motion = before.motion_information() + after.motion_information();
    BOOST_TEST((motion - expected.bottomRightCorner(states, states)).norm() < 1e-6 * motion.norm());
    BOOST_TEST((coupling - expected.topRightCorner(n, states)).norm() < 1e-6 * coupling.norm());
}
