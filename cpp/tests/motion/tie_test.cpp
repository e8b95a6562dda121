// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/motion/tie.hpp"

#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>

#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;
using motion::Kind;

namespace {

motion::Attitude attitude() { return {so3::exp(Vec3(0.3, -0.2, 1.1)), 1e-3}; }

motion::Tie tie_at(Kind kind, window::Gauge gauge, const Scene& scene, const std::vector<Vec3>& X, const SE3& T) {
    window::Slice slice({scene.X_told, gauge});
    slice.linearise(X);
    window::GaugeBasis rate_t(3 * static_cast<Eigen::Index>(X.size()), 7);
    slice.gauge_rate(rate_t);
    motion::Tie tie(static_cast<int>(X.size()));
    BOOST_TEST_REQUIRE(motion::measure(kind, T, X, slice, rate_t, attitude(), tie));
    return tie;
}

std::vector<Vec3> moved(std::vector<Vec3> X, const VecX& step) {
    for (std::size_t j = 0; j < X.size(); ++j) X[j] += step.segment<3>(3 * static_cast<Eigen::Index>(j));
    return X;
}

}  // namespace

BOOST_AUTO_TEST_CASE(derivatives_are_those_of_the_value) {
    const Scene scene = make_scene(8, 1, 0.0, 1.0, 2.0, 3);
    const SE3& T = scene.T_true.front();
    for (const window::Gauge gauge : {window::Gauge::similarity, window::Gauge::rigid}) {
        for (const Kind kind : {Kind::range, Kind::target, Kind::world}) {
            const int axes = motion::axes_of(kind);
            const motion::Tie tie = tie_at(kind, gauge, scene, scene.X_true, T);
            const double h = 1e-4;
            for (int i = 0; i < 6; ++i) {
                const Vec6 step = h * Vec6::Unit(i);
                const Vec3 slope = (tie_at(kind, gauge, scene, scene.X_true, perturb(T, step)).value -
                                    tie_at(kind, gauge, scene, scene.X_true, perturb(T, Vec6(-step))).value) /
                                   (2.0 * h);
                BOOST_TEST((slope - tie.J_pose.col(i)).head(axes).norm() < 1e-4 * (1.0 + slope.norm()));
            }
            for (Eigen::Index i = 0; i < tie.J_X_t.rows(); ++i) {
                const VecX step = h * VecX::Unit(tie.J_X_t.rows(), i);
                const Vec3 slope = (tie_at(kind, gauge, scene, moved(scene.X_true, step), T).value -
                                    tie_at(kind, gauge, scene, moved(scene.X_true, -step), T).value) /
                                   (2.0 * h);
                BOOST_TEST((slope - tie.J_X_t.row(i).transpose()).head(axes).norm() < 1e-4 * (1.0 + slope.norm()));
            }
        }
    }
}

BOOST_AUTO_TEST_CASE(the_gauge_does_not_change_the_value) {
    const Scene scene = make_scene(8, 1, 0.0, 1.0, 2.0, 4);
    const SE3& T = scene.T_true.front();
    const SE3 G{so3::exp(Vec3(0.02, 0.1, -0.05)), Vec3(1.0, -2.0, 0.5)};
    const double s = 1.03;
    std::vector<Vec3> X;
    for (const Vec3& x : scene.X_true) X.push_back(s * (G.R * x) + G.t);
    const SE3 T_moved{T.R * G.R.transpose(), s * T.t - T.R * G.R.transpose() * G.t};
    for (const Kind kind : {Kind::range, Kind::target, Kind::world}) {
        const Vec3 before = tie_at(kind, window::Gauge::similarity, scene, scene.X_true, T).value;
        const Vec3 after = tie_at(kind, window::Gauge::similarity, scene, X, T_moved).value;
        BOOST_TEST((before - after).norm() < 1e-8 * before.norm());
    }
}
