// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <new>

#include "fairlead/pnp/planar.hpp"
#include "fairlead/pnp/ransac.hpp"
#include "pnp/scene.hpp"

namespace {

// Plain counters: operator new may run before any other object of this program is alive.
int allocations = 0;

}  // namespace

// Not inlined: the compiler would see free() meet operator new and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* const memory = std::malloc(size > 0 ? size : 1)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace fairlead;
using namespace fairlead::testing;

BOOST_AUTO_TEST_SUITE(allocation_test)

BOOST_AUTO_TEST_CASE(finding_a_pose_allocates_nothing) {
    Random random(1);
    Scene scene = make_scene(random, 30, Vec3(1, 1, 1), 8.0, 1.0);
    spoil(scene, random, 10);
    const int before = allocations;
#ifdef EIGEN_RUNTIME_NO_MALLOC
    Eigen::internal::set_is_malloc_allowed(false);
#endif
    const pnp::RansacResult consensus = pnp::ransac(scene.X, scene.observations, scene.camera, Loss{});
    const pnp::PosePair pair =
        pnp::pose_pair(consensus.pose.T_camera_target, scene.X, scene.observations, scene.camera, Loss{});
    const pnp::Spread spread = pnp::spread(scene.X, scene.observations);
#ifdef EIGEN_RUNTIME_NO_MALLOC
    Eigen::internal::set_is_malloc_allowed(true);
#endif
    BOOST_TEST(allocations == before);
    BOOST_TEST(allocations > 0);
    BOOST_CHECK(consensus.ok && pair.best.ok && spread.flatness > 0.0);
}

BOOST_AUTO_TEST_SUITE_END()
