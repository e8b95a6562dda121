// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>
#include <cmath>

namespace fairlead::speed {

/// A pose as Ceres holds it: quaternion x y z w, then t; p_camera = R(q) X + t.
using PoseBlock = Eigen::Matrix<double, 7, 1>;

inline Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

/// T Exp(xi), xi = [rho; phi], CONVENTIONS.md eq. (5)-(6). Cost functions hand Ceres derivatives with respect to xi in
/// the first six of the seven columns and this says that they are right; so no product with a dense 7 x 6 of the
/// quaternion's derivative is needed.
class RightPerturbation final : public ceres::Manifold {
  public:
    int AmbientSize() const override { return 7; }
    int TangentSize() const override { return 6; }

    bool Plus(const double* x, const double* delta, double* result) const override {
        const Eigen::Map<const Eigen::Quaterniond> q(x);
        const Eigen::Map<const Eigen::Vector3d> t(x + 4);
        const Eigen::Map<const Eigen::Vector3d> rho(delta);
        const Eigen::Map<const Eigen::Vector3d> phi(delta + 3);
        const double angle = phi.norm();
        const double half = 0.5 * angle;
        const double sinc_half = angle < 1e-8 ? 0.5 : std::sin(half) / angle;
        const Eigen::Vector3d v = sinc_half * phi;
        const double b = angle < 1e-4 ? 0.5 - angle * angle / 24.0 : (1.0 - std::cos(angle)) / (angle * angle);
        const double c =
            angle < 1e-4 ? (1.0 - angle * angle / 20.0) / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
        const Eigen::Vector3d turned = phi.cross(rho);
        const Eigen::Vector3d moved = rho + b * turned + c * phi.cross(turned);
        Eigen::Map<Eigen::Vector3d>(result + 4) = q * moved + t;
        Eigen::Map<Eigen::Quaterniond>(result).coeffs() =
            (q * Eigen::Quaterniond(std::cos(half), v.x(), v.y(), v.z())).normalized().coeffs();
        return true;
    }

    bool PlusJacobian(const double*, double* jacobian) const override {
        Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
        return true;
    }

    bool Minus(const double*, const double*, double*) const override { return false; }  // not asked for by the solver
    bool MinusJacobian(const double*, double*) const override { return false; }
};

struct Pinhole {
    double fx, fy, cx, cy;
};

/// r = (pi(T X) - z) / sigma; with B = d r / d X the derivative with respect to xi is B [I, -hat(X)], docs/estimator.md
/// eq. (5)-(6).
class Reprojection final : public ceres::SizedCostFunction<2, 7, 3> {
  public:
    Reprojection(const Pinhole& camera, const Eigen::Vector2d& z, double sigma_px)
        : camera_(camera), z_(z), weight_(1.0 / sigma_px) {}

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const Eigen::Matrix3d R = Eigen::Map<const Eigen::Quaterniond>(parameters[0]).toRotationMatrix();
        const Eigen::Map<const Eigen::Vector3d> X(parameters[1]);
        const Eigen::Vector3d p = R * X + Eigen::Map<const Eigen::Vector3d>(parameters[0] + 4);
        if (!(p.z() > 1e-6)) return false;
        const double w = weight_ / p.z();
        residuals[0] = camera_.fx * w * p.x() + weight_ * (camera_.cx - z_.x());
        residuals[1] = camera_.fy * w * p.y() + weight_ * (camera_.cy - z_.y());
        if (jacobians == nullptr) return true;
        Eigen::Matrix<double, 2, 3> J;
        J << camera_.fx * w, 0.0, -camera_.fx * w * p.x() / p.z(), 0.0, camera_.fy * w, -camera_.fy * w * p.y() / p.z();
        const Eigen::Matrix<double, 2, 3> B = J * R;
        if (jacobians[0] != nullptr) {
            Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> J_pose(jacobians[0]);
            J_pose.leftCols<3>() = B;
            J_pose.middleCols<3>(3).noalias() = -B * hat(X);
            J_pose.col(6).setZero();
        }
        if (jacobians[1] != nullptr) {
            Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> J_landmark(jacobians[1]);
            J_landmark = B;
        }
        return true;
    }

  private:
    Pinhole camera_;
    Eigen::Vector2d z_;
    double weight_;
};

/// r = (X - X0) / sigma of `Rows` coordinates from `first` on; a row beyond the third is zero.
template <int Rows>
class LandmarkPrior final : public ceres::SizedCostFunction<Rows, 3> {
  public:
    LandmarkPrior(const Eigen::Vector3d& X0, double sigma_m, int first)
        : X0_(X0), weight_(1.0 / sigma_m), first_(first) {}

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
        if (wanted) std::fill_n(jacobians[0], 3 * Rows, 0.0);
        for (int row = 0; row < Rows; ++row) {
            const int axis = first_ + row;
            residuals[row] = axis < 3 ? weight_ * (parameters[0][axis] - X0_[axis]) : 0.0;
            if (wanted && axis < 3) jacobians[0][3 * row + axis] = weight_;
        }
        return true;
    }

  private:
    Eigen::Vector3d X0_;
    double weight_;
    int first_;
};

}  // namespace fairlead::speed
