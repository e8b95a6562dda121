// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <boost/test/unit_test.hpp>
#include <cstdlib>
#include <new>

#include "fairlead/tracker.hpp"
#include "window/scene.hpp"

using namespace fairlead;
using namespace fairlead::testing;

namespace {

bool counting = false;
int allocations = 0;

void* take(std::size_t size) {
    if (counting) ++allocations;
    if (void* p = std::malloc(size)) return p;
    throw std::bad_alloc();
}

/// Allocations of operator new and of Eigen during updates after construction, ranges and attitudes told between them.
int allocations_of_flight(int landmarks, int views, int max_views, TrackerOptions options = {}) {
    const Scene scene = make_scene(landmarks, views, 1.5, 1.0, 1.0, 51);
    options.max_views = max_views;
    Tracker tracker(scene.camera, scene.X_told, independent_prior(scene, 1.0), options);
    allocations = 0;
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
        const std::int64_t stamp = 40'000'000 * static_cast<std::int64_t>(k + 1);
        const SE3& T = scene.T_true[k];
        const std::span<const Observation> view(scene.views[k]);
        tracker.add_attitude(stamp, T.R.transpose(), 1e-3);
        if (k % 5 == 0) tracker.add_range(stamp, (T * scene.X_true[2]).norm(), 0.5, 2);
        counting = true;
        Eigen::internal::set_is_malloc_allowed(false);
        (void)tracker.update(stamp, k == 40 ? view.first(0) : view);
        Eigen::internal::set_is_malloc_allowed(true);
        counting = false;
    }
    BOOST_TEST(tracker.ranges_believed() > 0);
    return allocations;
}

}  // namespace

void* operator new(std::size_t size) { return take(size); }
void* operator new[](std::size_t size) { return take(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

BOOST_AUTO_TEST_CASE(update_allocates_nothing) {
    BOOST_TEST(allocations_of_flight(20, 90, 16) == 0);
    BOOST_TEST(allocations_of_flight(100, 24, 8) == 0);
    TrackerOptions alike;
    alike.correlation_angle_rad = 0.2;
    alike.correlation_log_range = 1.5;
    BOOST_TEST(allocations_of_flight(20, 90, 16, alike) == 0);
}

BOOST_AUTO_TEST_CASE(update_on_a_smooth_path_allocates_nothing) {
    for (const motion::Kind kind : {motion::Kind::range, motion::Kind::target, motion::Kind::world}) {
        TrackerOptions smooth;
        smooth.motion = kind;
        BOOST_TEST(allocations_of_flight(20, 90, 16, smooth) == 0);
        BOOST_TEST(allocations_of_flight(100, 40, 8, smooth) == 0);
    }
}
