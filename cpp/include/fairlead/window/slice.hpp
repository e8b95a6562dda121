// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fairlead/window/similarity.hpp"

namespace fairlead::window {

/// What images leave free of the model: its similarity, or its rigid motion where something measured a length.
enum class Gauge { similarity, rigid };

/// What a model is aligned onto. The last entries may be no landmarks: they are set aside, and no gauge moves them.
struct Reference {
    std::span<const Vec3> X;
    Gauge gauge = Gauge::similarity;
    int aside = 0;
};

/// The shape of a model: y = S(X) X, aligned onto a reference by the gauge S that makes N_ref^T (y - X_ref) = 0. A
/// function of y does not change along the gauge, docs/estimator.md eq. (11)-(12). All memory is taken at construction.
class Slice {
  public:
    explicit Slice(const Reference& reference);

    /// y and u = y - X_ref of a model, without derivatives.
    void align(std::span<const Vec3> X) noexcept;
    /// The same with what the functions below need.
    void linearise(std::span<const Vec3> X) noexcept;

    [[nodiscard]] const VecX& u() const noexcept { return u_; }
    [[nodiscard]] const Similarity& similarity() const noexcept { return S_; }
    [[nodiscard]] double radius() const noexcept { return radius_; }
    [[nodiscard]] Vec3 centre() const noexcept;  ///< of y
    /// Those entries of a model that are landmarks.
    [[nodiscard]] std::span<const Vec3> landmarks(std::span<const Vec3> X) const noexcept {
        return X.first(landmarks_);
    }
    /// d y_j / d X_j with the gauge held: s R of a landmark, one of what is set aside. `row` is 3 j.
    [[nodiscard]] const Mat33& factor(Eigen::Index row) const noexcept { return is_landmark(row) ? factor_ : one_; }
    /// Its inverse, transposed: what a gradient by X_j is by y_j.
    [[nodiscard]] const Mat33& lift(Eigen::Index row) const noexcept { return is_landmark(row) ? lift_ : one_; }

    /// d E / d X from d E / d y, column by column, in place: (s R)^T P^T C with the oblique projector P.
    template <typename Columns>
    void pull_back(Eigen::MatrixBase<Columns>& C) noexcept;
    /// d^2 E / d X^2 from A = d^2 E / d y^2, both symmetric and full; A is scratch afterwards.
    void pull_back(MatX& A, MatX& H) noexcept;
    /// d gamma / d X (7 x 3N) of the gauge S = Exp(gamma) S in the basis N(y), transposed: -(s R)^T U^T.
    void gauge_rate(GaugeBasis& rate_t) const noexcept;

  private:
    [[nodiscard]] bool is_landmark(Eigen::Index row) const noexcept {
        return row < 3 * static_cast<Eigen::Index>(landmarks_);
    }

    Gauge gauge_;
    std::size_t landmarks_;
    std::vector<Vec3> X_ref_, y_;
    double radius_ = 1.0;
    Similarity S_;
    Mat33 factor_ = Mat33::Identity(), lift_ = factor_, one_ = factor_;
    VecX u_;
    GaugeBasis N_, N_ref_, U_t_, AN_;
};

template <typename Columns>
void Slice::pull_back(Eigen::MatrixBase<Columns>& C) noexcept {
    for (Eigen::Index c = 0; c < C.cols(); ++c) {
        const Eigen::Matrix<double, 7, 1> along = N_.transpose() * C.col(c);
        C.col(c).noalias() -= U_t_ * along;
        for (Eigen::Index j = 0; j < C.rows(); j += 3)
            C.col(c).template segment<3>(j) = (factor(j).transpose() * C.col(c).template segment<3>(j)).eval();
    }
}

}  // namespace fairlead::window
