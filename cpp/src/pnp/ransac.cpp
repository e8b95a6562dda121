// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/ransac.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fairlead/pnp/p3p.hpp"
#include "usable.hpp"

namespace fairlead::pnp {
namespace {

constexpr int kLeastIterations = 10;     // a good sample may be an ill-conditioned one
constexpr int kLocalIterations = 6;      // of the refinement of each new best
constexpr double kLocalWidening = 16.0;  // its threshold: a pose from three points misses by more than the noise
constexpr int kDraws = 32;               // attempts to draw three usable, different landmarks

/// Uniform integers from a seed (splitmix64), the same on every platform.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) noexcept : state_(seed) {}
    std::size_t below(std::size_t n) noexcept {
        state_ += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return static_cast<std::size_t>((z ^ (z >> 31)) % n);
    }

  private:
    std::uint64_t state_;
};

struct Score {
    double cost = std::numeric_limits<double>::infinity();
    int inliers = 0;
};

struct Search {
    std::span<const Vec3> X;
    std::span<const Observation> observations;
    const Camera& camera;
    const Loss& loss;
    Score best;
    SE3 T_best;
    bool found = false;

    [[nodiscard]] const Vec3& landmark(const Observation& o) const noexcept {
        return X[static_cast<std::size_t>(o.landmark)];
    }
};

/// sum rho(s), given up once it cannot become the best.
Score score(const Search& search, const SE3& T) noexcept {
    Score total{.cost = 0.0};
    const double hidden = std::isfinite(search.loss.threshold) ? search.loss.bound() : kHiddenCost;
    for (const Observation& o : search.observations) {
        if (!is_usable(o, search.X)) continue;
        Vec2 z;
        if (!search.camera.project(T * search.landmark(o), z)) {
            total.cost += hidden;
        } else {
            const double s = squared_residual(z - o.z, o.covariance);
            total.cost += search.loss.rho(s);
            total.inliers += s <= search.loss.threshold ? 1 : 0;
        }
        if (!(total.cost < search.best.cost)) return {};
    }
    return total;
}

bool take_if_better(Search& search, const SE3& T) noexcept {
    const Score candidate = score(search, T);
    if (!(candidate.cost < search.best.cost)) return false;
    search.best = candidate;
    search.T_best = T;
    search.found = true;
    return true;
}

/// Chum et al. 2003: what three points gave is refined on all that roughly agree, then on what agrees.
void optimise_locally(Search& search) noexcept {
    const Loss wide{kLocalWidening * search.loss.threshold};
    const RefineResult rough =
        refine(search.T_best, search.X, search.observations, search.camera, wide, kLocalIterations);
    if (!rough.ok) return;
    const RefineResult fine =
        refine(rough.T_camera_target, search.X, search.observations, search.camera, search.loss, kLocalIterations);
    (void)take_if_better(search, fine.ok ? fine.T_camera_target : rough.T_camera_target);
}

/// Three different landmarks and the rays they were seen along.
bool draw(const Search& search, Dice& dice, std::array<Vec3, 3>& rays, std::array<Vec3, 3>& X) noexcept {
    std::array<int, 3> chosen{-1, -1, -1};
    std::size_t count = 0;
    for (int i = 0; i < kDraws && count < 3; ++i) {
        const Observation& o = search.observations[dice.below(search.observations.size())];
        if (std::find(chosen.begin(), chosen.end(), o.landmark) != chosen.end() || !is_usable(o, search.X)) continue;
        if (!search.camera.unproject(o.z, rays[count])) continue;
        X[count] = search.landmark(o);
        chosen[count++] = o.landmark;
    }
    return count == 3;
}

/// Samples after which all three points were inliers once, with the confidence asked for (Fischler and Bolles 1981).
int iterations_needed(double inlier_ratio, const RansacOptions& options) noexcept {
    const double good = inlier_ratio * inlier_ratio * inlier_ratio;
    if (good >= 1.0) return kLeastIterations;
    const double needed = std::log(1.0 - options.confidence) / std::log1p(-good);
    if (!(needed < options.max_iterations)) return options.max_iterations;
    return std::max(kLeastIterations, static_cast<int>(std::ceil(needed)));
}

/// Whether inliers stand on at least four different places of the target: three leave up to four poses.
bool four_places(const Search& search, const SE3& T) noexcept {
    std::array<Vec3, 4> places;
    std::size_t count = 0;
    for (const Observation& o : search.observations) {
        Vec2 z;
        if (!is_usable(o, search.X) || !search.camera.project(T * search.landmark(o), z)) continue;
        if (squared_residual(z - o.z, o.covariance) > search.loss.threshold) continue;
        const Vec3& X = search.landmark(o);
        const auto* const end = places.data() + count;
        if (std::find(static_cast<const Vec3*>(places.data()), end, X) != end) continue;
        places[count++] = X;
        if (count == 4) return true;
    }
    return false;
}

}  // namespace

RansacResult ransac(std::span<const Vec3> X_target, std::span<const Observation> observations, const Camera& camera,
                    const Loss& loss, const RansacOptions& options) noexcept {
    RansacResult result;
    Search search{.X = X_target,
                  .observations = observations,
                  .camera = camera,
                  .loss = loss,
                  .best = {},
                  .T_best = {},
                  .found = false};
    const auto usable = std::count_if(observations.begin(), observations.end(),
                                      [&](const Observation& o) { return is_usable(o, X_target); });
    if (usable < 4) return result;
    Dice dice(options.seed);
    std::array<Vec3, 3> rays, X;
    std::array<SE3, 4> hypotheses;
    int needed = options.max_iterations;
    for (; result.iterations < needed; ++result.iterations) {
        if (!draw(search, dice, rays, X)) continue;
        const int count = p3p(rays, X, hypotheses);
        bool improved = false;
        for (int i = 0; i < count; ++i)
            improved = take_if_better(search, hypotheses[static_cast<std::size_t>(i)]) || improved;
        if (!improved) continue;
        optimise_locally(search);
        needed = iterations_needed(static_cast<double>(search.best.inliers) / static_cast<double>(usable), options);
    }
    if (!search.found) return result;
    optimise_locally(search);  // the loss makes local minima; from the best pose the wide one leads out of some
    result.pose = refine(search.T_best, X_target, observations, camera, loss);
    result.ok = result.pose.ok && result.pose.inliers >= 4 && four_places(search, result.pose.T_camera_target);
    return result;
}

}  // namespace fairlead::pnp
