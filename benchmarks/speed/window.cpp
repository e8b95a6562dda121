// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The window solve of the core, asked through stdin: serve.hpp.
#include <cmath>
#include <limits>

#include "fairlead/window/levenberg_marquardt.hpp"
#include "serve.hpp"

namespace {

using namespace fairlead;

/// N(X0, P0) as the peers have it: of a model without a size of its own (docs/estimator.md eq. (2) with x0 = 0).
window::LandmarkPrior plain_prior(const std::vector<Vec3>& X0, double sigma_m) {
    const Eigen::Index rows = 3 * static_cast<Eigen::Index>(X0.size());
    window::LandmarkPrior prior = window::make_prior(X0, sigma_m * sigma_m * MatX::Identity(rows, rows));
    prior.outline.setZero();
    prior.pull.setZero();
    prior.scale_information = 1.0;
    return prior;
}

class Core {
  public:
    void prepare(const speed::ProblemFile& file) {
        const int n = static_cast<int>(file.X0.size());
        start_ = window::Problem{};
        start_.camera = {.width = 1024, .height = 1024, .fx = file.fx, .fy = file.fy, .cx = file.cx, .cy = file.cy};
        start_.X = file.X0;
        start_.loss.threshold = std::numeric_limits<double>::infinity();
        start_.prior = plain_prior(file.X0, file.prior_sigma_m);
        const Mat22 information = Mat22::Identity() / (file.sigma_px * file.sigma_px);
        for (std::size_t k = 0; k < file.R.size(); ++k) {
            window::ViewBlock view(n);
            view.state.T_camera_target = {file.R[k], file.t[k]};
            for (int j = 0; j < n; ++j)
                view.measurements.push_back(
                    {j, file.pixels[k * file.X0.size() + static_cast<std::size_t>(j)], information});
            start_.views.push_back(std::move(view));
        }
    }

    speed::Answer solve(const speed::Settings& settings, double& seconds) {
        window::Problem problem = start_;
        const window::LmOptions options{.max_iterations = settings.max_iterations,
                                        .initial_damping = settings.damping,
                                        .tolerance = settings.tolerance};
        const double begin = speed::processor_seconds();
        window::Workspace workspace(problem.landmarks());
        const window::LmSummary summary = window::levenberg_marquardt(problem, options, workspace);
        seconds = speed::processor_seconds() - begin;
        if (!summary.ok) throw std::runtime_error("the core's window solve failed");
        speed::Answer answer{problem.X, {}, {}, summary.iterations};
        for (const window::ViewBlock& view : problem.views) {
            answer.R.push_back(view.state.T_camera_target.R);
            answer.t.push_back(view.state.T_camera_target.t);
        }
        return answer;
    }

  private:
    window::Problem start_;
};

}  // namespace

int main() { return fairlead::speed::serve<Core>(); }
