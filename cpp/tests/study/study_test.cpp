// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/study.hpp"

#include <Eigen/Dense>
#include <array>
#include <boost/test/unit_test.hpp>

#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;
using study::Method;

namespace {

constexpr std::array kMethods{Method::start,  Method::single_view, Method::free_window, Method::map,
                              Method::online, Method::true_model,  Method::bound};

study::Flight make_flight(std::uint64_t seed) {
    const Scene scene = make_scene(12, 4, 1.2, 0.5, 1.0, seed);
    study::Flight flight{.X_true = scene.X_true,
                         .X0 = scene.X_told,
                         .P0 = independent_prior(scene, 1.0),
                         .stamps_ns = {},
                         .T_true = scene.T_true,
                         .T_start = scene.T_true,
                         .views = scene.views};
    for (std::int64_t k = 0; k < 4; ++k) flight.stamps_ns.push_back(k * 3'000'000'000);
    return flight;
}

Camera camera() { return make_scene(4, 1, 0.0, 1.0, 1.0, 0).camera; }

}  // namespace

BOOST_AUTO_TEST_CASE(answers_do_not_depend_on_the_number_of_threads) {
    std::vector<study::Flight> flights;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) flights.push_back(make_flight(seed));
    for (const Method method : kMethods) {
        const auto one = study::solve_all(method, camera(), flights, {}, 1);
        const auto four = study::solve_all(method, camera(), flights, {}, 4);
        BOOST_TEST_REQUIRE(one.size() == 5U);
        for (std::size_t i = 0; i < one.size(); ++i)
            for (std::size_t k = 0; k < 4; ++k) {
                BOOST_TEST((one[i].T_camera_target[k].t == four[i].T_camera_target[k].t));
                BOOST_TEST((one[i].covariances[k] == four[i].covariances[k]));
            }
    }
}

BOOST_AUTO_TEST_CASE(the_true_model_beats_the_told_one_and_the_bound_knows_it) {
    double told = 0.0, true_model = 0.0, bound = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const study::Flight flight = make_flight(seed);
        const auto error = [&](Method method) {
            const study::Answer answer = study::solve(method, camera(), flight, {});
            return (answer.T_camera_target[1].t - flight.T_true[1].t).squaredNorm();
        };
        told += error(Method::single_view);
        true_model += error(Method::true_model);
        const study::Answer least = study::solve(Method::bound, camera(), flight, {});
        bound += least.covariances[1].topLeftCorner<3, 3>().trace();
        BOOST_TEST((least.X_covariance.diagonal().array() < 1.0).all());  // less than the prior
    }
    BOOST_TEST(true_model < 0.5 * told);
    BOOST_TEST(bound < told);
}

BOOST_AUTO_TEST_CASE(a_landmark_seen_once_stays_where_it_is_told) {
    study::Flight flight = make_flight(3);
    for (std::size_t k = 1; k < 4; ++k)
        std::erase_if(flight.views[k], [](const Observation& o) { return o.landmark == 7; });
    const study::Answer answer = study::solve(Method::free_window, camera(), flight, {});
    BOOST_TEST((answer.X[7] == flight.X0[7]));
    BOOST_TEST((answer.X[6] != flight.X0[6]));
    for (const SE3& T : answer.T_camera_target) BOOST_TEST(T.t.allFinite());
}

BOOST_AUTO_TEST_CASE(what_a_thread_throws_arrives) {
    std::vector<study::Flight> flights{make_flight(1), make_flight(2)};
    flights[1].P0(0, 0) = -1.0;
    BOOST_CHECK_THROW((void)study::solve_all(Method::map, camera(), flights, {}, 2), std::invalid_argument);
    flights[1].T_true.pop_back();
    BOOST_CHECK_THROW((void)study::solve_all(Method::start, camera(), flights, {}, 1), std::invalid_argument);
    BOOST_CHECK_THROW((void)study::solve_all(Method::start, camera(), flights, {}, 0), std::invalid_argument);
}
