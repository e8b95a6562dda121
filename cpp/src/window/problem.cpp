// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/window/problem.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::window {
namespace {

Eigen::Map<const VecX> stacked(std::span<const Vec3> X) {
    return {X.data()->data(), 3 * static_cast<Eigen::Index>(X.size())};
}

void add(const CompressedViews& views, Workspace& workspace) noexcept {
    workspace.S += views.hessian();
    workspace.g += views.gradient();
    workspace.D += views.hessian().diagonal();
}

double length_cost(std::span<const LengthMeasurement> lengths, std::span<const Vec3> X) noexcept {
    double cost = 0.0;
    for (const LengthMeasurement& m : lengths) {
        const double d = (X[static_cast<std::size_t>(m.a)] - X[static_cast<std::size_t>(m.b)]).norm();
        cost += std::pow((d - m.length_m) / m.sigma_m, 2);
    }
    return cost;
}

void add_lengths(std::span<const LengthMeasurement> lengths, std::span<const Vec3> X, Workspace& workspace) noexcept {
    for (const LengthMeasurement& m : lengths) {
        const Vec3 difference = X[static_cast<std::size_t>(m.a)] - X[static_cast<std::size_t>(m.b)];
        const Vec3 J = difference.normalized() / m.sigma_m;
        const double r = (difference.norm() - m.length_m) / m.sigma_m;
        const Mat33 JJ = J * J.transpose();
        const int a = 3 * m.a;
        const int b = 3 * m.b;
        workspace.S.block<3, 3>(a, a) += JJ;
        workspace.S.block<3, 3>(b, b) += JJ;
        workspace.S.block<3, 3>(std::max(a, b), std::min(a, b)) -= JJ;
        workspace.g.segment<3>(a) += r * J;
        workspace.g.segment<3>(b) -= r * J;
        workspace.D.segment<3>(a) += JJ.diagonal();
        workspace.D.segment<3>(b) += JJ.diagonal();
    }
}

/// S times the data's scale, and the prior at X, divided by its factor. With e the difference of X from the told
/// landmarks but for its scale s, y = P0^-1 e, p = P0^-1 x0 and i = x0^T p: d = (s - 1) x0 + e / s has
///   J^T P0^-1 d = (s - 1 - y^T e / (i s^3)) p + y / s^2,
///   J^T P0^-1 J = P0^-1 / s^2 + ((1 - 1 / s^2) / i + y^T e / (i^2 s^4)) p p^T - (y p^T + p y^T) / (i s^3).
void add_prior(const LandmarkPrior& prior, std::span<const Vec3> X, double factor, double data_scale,
               Workspace& workspace) noexcept {
    const double s = prior.scale(X);
    const double i = prior.scale_information;
    const VecX& p = prior.pull;
    workspace.step = stacked(X) - prior.mean - (s - 1.0) * prior.outline;
    VecX& y = workspace.pulled;
    y.noalias() = prior.information * workspace.step;
    const double shape = y.dot(workspace.step);
    const double own = (1.0 - 1.0 / (s * s)) / i + shape / (i * i * std::pow(s, 4));
    const double mixed = -1.0 / (i * std::pow(s, 3));
    workspace.g += ((s - 1.0 - shape / (i * std::pow(s, 3))) * p + y / (s * s)) / factor;
    workspace.D += prior.information.diagonal() / (factor * s * s);
    for (Eigen::Index c = 0; c < p.size(); ++c) {
        const Eigen::Index rows = p.size() - c;
        auto column = workspace.S.col(c).tail(rows);
        column = data_scale * column + prior.information.col(c).tail(rows) / (factor * s * s) +
                 ((own * p[c] + mixed * y[c]) / factor) * p.tail(rows) + (mixed * p[c] / factor) * y.tail(rows);
    }
}

}  // namespace

Workspace::Workspace(int landmarks)
    : eliminator(landmarks),
      cholesky(3 * landmarks),
      evidence(landmarks),
      X_before(static_cast<std::size_t>(landmarks), Vec3::Zero()) {
    product.resize(3 * landmarks, 3 * landmarks);
    S.setZero(3 * landmarks, 3 * landmarks);
    for (VecX* vector : {&g, &dX, &D, &step, &pulled}) vector->setZero(3 * landmarks);
}

double posterior_cost(Problem& problem) noexcept {
    double data = problem.path ? problem.path->value(problem.X) : 0.0;
    for (CompressedViews& views : problem.compressed)
        if (!views.empty()) data += views.value(problem.X);
    for (const ViewBlock& view : problem.views) data += view.cost;
    double prior = problem.prior ? squared_distance(*problem.prior, problem.X) : 0.0;
    const double known =
        length_cost(problem.lengths, problem.X) + (problem.prior ? aside_cost(*problem.prior, problem.X) : 0.0);
    return 0.5 * (data / problem.noise_factor + prior / problem.prior_factors.believed + known);
}

bool linearise(Problem& problem) noexcept {
    const Loss loss = problem.told_loss();
    for (ViewBlock& view : problem.views)
        if (!linearise(problem.camera, problem.X, loss, problem.noise_factor, view)) return false;
    for (CompressedViews& views : problem.compressed)
        if (!views.empty()) views.linearise(problem.X);
    if (problem.path) problem.path->linearise(problem.X);
    return true;
}

bool assemble_data(Problem& problem, double damping, Workspace& workspace) noexcept {
    workspace.S.triangularView<Eigen::Lower>().setZero();
    workspace.g.setZero();
    workspace.D.setZero();
    for (ViewBlock& view : problem.views) {
        if (!factor_state(damping, view)) return false;
        workspace.eliminator.add(view, problem.X, workspace.S, workspace.g);
        for (const PointTerm& term : view.terms) {
            workspace.D.segment<3>(3 * term.landmark) += term.M.diagonal();
            if (term.bias >= 0) workspace.D[3 * term.bias] += term.along.dot(term.M * term.along);
        }
    }
    workspace.eliminator.flush(workspace.S);
    for (const CompressedViews& views : problem.compressed)
        if (!views.empty()) add(views, workspace);
    if (problem.path) add(*problem.path, workspace);
    return workspace.S.diagonal().allFinite();  // no element off the diagonal is larger
}

void assemble(const Quadratic& data, std::span<const Vec3> X, Workspace& workspace) noexcept {
    workspace.step = stacked(X) - stacked(data.X);
    workspace.S = data.H;
    workspace.g = data.g;
    workspace.g.noalias() += data.H.selfadjointView<Eigen::Lower>() * workspace.step;
}

void scale_and_add_prior(const Problem& problem, std::span<const Vec3> X, Workspace& workspace) noexcept {
    const double data_scale = 1.0 / problem.noise_factor;
    workspace.g *= data_scale;
    workspace.D *= data_scale;
    if (problem.prior) {
        add_prior(*problem.prior, X, problem.prior_factors.believed, data_scale, workspace);
        workspace.S.diagonal() += problem.prior->aside;
        workspace.D += problem.prior->aside;
        workspace.g += problem.prior->aside.cwiseProduct(stacked(X));
    } else {
        workspace.S *= data_scale;
    }
    add_lengths(problem.lengths, X, workspace);
}

}  // namespace fairlead::window
