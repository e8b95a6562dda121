// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// The same window solve by Ceres, asked through stdin: ../serve.hpp. Variants: ORDER-LIBRARY with order `poses` or
// `landmarks` (what is eliminated first, DENSE_SCHUR) and library `eigen` or `lapack` (of the dense factorisation); or
// `sparse` (SPARSE_NORMAL_CHOLESKY).
#include <ceres/ceres.h>

#include <algorithm>
#include <memory>

#include "../serve.hpp"
#include "cost.hpp"

namespace {

using namespace fairlead::speed;

class Ceres {
  public:
    void prepare(const ProblemFile& file) {
        file_ = file;
        problem_.reset();
    }

    Answer solve(const Settings& settings, double& seconds) {
        const bool landmarks_first = settings.variant.rfind("landmarks", 0) == 0;
        if (!problem_ || landmarks_first != landmarks_first_) build(landmarks_first);
        reset();
        ceres::Solver::Options options = make_options(settings);
        ceres::Solver::Summary summary;
        const double begin = processor_seconds();
        ceres::Solve(options, problem_.get(), &summary);
        seconds = processor_seconds() - begin;
        if (!summary.IsSolutionUsable()) throw std::runtime_error(summary.message);
        return answer(summary.num_linear_solves);
    }

  private:
    ceres::Solver::Options make_options(const Settings& settings) {
        ceres::Solver::Options options;
        options.num_threads = 1;
        options.logging_type = ceres::SILENT;
        options.max_num_iterations = settings.max_iterations;
        options.initial_trust_region_radius = 1.0 / settings.damping;
        options.function_tolerance = settings.tolerance;
        options.gradient_tolerance = 0.0;
        options.parameter_tolerance = 0.0;
        if (settings.variant == "sparse") {
            options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
            return options;
        }
        options.linear_solver_type = ceres::DENSE_SCHUR;
        options.dense_linear_algebra_library_type = settings.variant.ends_with("lapack") ? ceres::LAPACK : ceres::EIGEN;
        auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
        for (PoseBlock& T : T_) ordering->AddElementToGroup(T.data(), landmarks_first_ ? 1 : 0);
        for (Eigen::Vector3d& X : X_) ordering->AddElementToGroup(X.data(), landmarks_first_ ? 0 : 1);
        options.linear_solver_ordering = ordering;
        return options;
    }

    /// With the landmarks first, the prior's three rows come as two blocks of two rows: then all rows are alike and
    /// Ceres takes its compiled 2-3-6 elimination instead of the general one.
    void build(bool landmarks_first) {
        landmarks_first_ = landmarks_first;
        T_.resize(file_.R.size());
        X_.resize(file_.X0.size());
        ceres::Problem::Options options;
        options.disable_all_safety_checks = true;
        problem_ = std::make_unique<ceres::Problem>(options);
        const Pinhole camera{file_.fx, file_.fy, file_.cx, file_.cy};
        for (std::size_t k = 0; k < T_.size(); ++k) {
            problem_->AddParameterBlock(T_[k].data(), 7, new RightPerturbation);
            for (std::size_t j = 0; j < X_.size(); ++j)
                problem_->AddResidualBlock(new Reprojection(camera, file_.pixels[k * X_.size() + j], file_.sigma_px),
                                           nullptr, T_[k].data(), X_[j].data());
        }
        for (std::size_t j = 0; j < X_.size(); ++j) {
            double* X = X_[j].data();
            if (landmarks_first) {
                problem_->AddResidualBlock(new LandmarkPrior<2>(file_.X0[j], file_.prior_sigma_m, 0), nullptr, X);
                problem_->AddResidualBlock(new LandmarkPrior<2>(file_.X0[j], file_.prior_sigma_m, 2), nullptr, X);
            } else {
                problem_->AddResidualBlock(new LandmarkPrior<3>(file_.X0[j], file_.prior_sigma_m, 0), nullptr, X);
            }
        }
    }

    void reset() {
        std::copy(file_.X0.begin(), file_.X0.end(), X_.begin());
        for (std::size_t k = 0; k < T_.size(); ++k)
            T_[k] << Eigen::Quaterniond(file_.R[k]).normalized().coeffs(), file_.t[k];
    }

    Answer answer(int iterations) const {
        Answer found{X_, {}, {}, iterations};
        for (const PoseBlock& T : T_) {
            found.R.push_back(Eigen::Map<const Eigen::Quaterniond>(T.data()).toRotationMatrix());
            found.t.push_back(T.tail<3>());
        }
        return found;
    }

    ProblemFile file_;
    bool landmarks_first_ = false;
    std::vector<PoseBlock> T_;
    std::vector<Eigen::Vector3d> X_;
    std::unique_ptr<ceres::Problem> problem_;  // refers to T_ and X_
};

}  // namespace

int main() { return fairlead::speed::serve<Ceres>(); }
