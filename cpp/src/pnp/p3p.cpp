// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/pnp/p3p.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fairlead::pnp {
namespace {

constexpr double kCollinear = 1e-10;  // sine below which three points or rays are on a line or in a plane
constexpr double kAgreement = 1e-6;   // relative error of the squared sides at an accepted solution
constexpr int kPolishing = 5;         // Newton steps on the depths; two are usual

/// The triangle seen: squared sides 12, 13, 23 [m^2], and squared chords of the unit rays to its corners.
struct Triangle {
    Vec3 squared_sides = Vec3::Zero();
    Vec3 squared_chords = Vec3::Zero();

    /// |d_i m_i - d_j m_j|^2 = (d_i - d_j)^2 + d_i d_j |m_i - m_j|^2: nothing cancels where the rays are nearly
    /// parallel.
    [[nodiscard]] Vec3 sides_at(const Vec3& d) const noexcept {
        const double a = d[0] - d[1], b = d[0] - d[2], c = d[1] - d[2];
        return {a * a + d[0] * d[1] * squared_chords[0], b * b + d[0] * d[2] * squared_chords[1],
                c * c + d[1] * d[2] * squared_chords[2]};
    }
    [[nodiscard]] Mat33 derivative(const Vec3& d) const noexcept {
        const double a = 2.0 * (d[0] - d[1]), b = 2.0 * (d[0] - d[2]), c = 2.0 * (d[1] - d[2]);
        Mat33 J;
        J << a + d[1] * squared_chords[0], -a + d[0] * squared_chords[0], 0.0,  //
            b + d[2] * squared_chords[1], 0.0, -b + d[0] * squared_chords[1],   //
            0.0, c + d[2] * squared_chords[2], -c + d[1] * squared_chords[2];
        return J;
    }
};

/// The three squared sides as quadratic forms of e = (scale d_1, d_2 - d_1, d_3 - d_1); entries of order one however
/// far the triangle, when scale is the typical chord. docs/pnp.md eq. (2).
std::array<Mat33, 3> side_forms(const Vec3& squared_chords, double scale) noexcept {
    const Vec3& k = squared_chords;
    std::array<Mat33, 3> forms;
    const double h = 0.5 / scale, u = 1.0 / (scale * scale);
    forms[0] << k[0] * u, k[0] * h, 0.0, k[0] * h, 1.0, 0.0, 0.0, 0.0, 0.0;
    forms[1] << k[1] * u, 0.0, k[1] * h, 0.0, 0.0, 0.0, k[1] * h, 0.0, 1.0;
    forms[2] << k[2] * u, k[2] * h, k[2] * h, k[2] * h, 1.0, 0.5 * k[2] - 1.0, k[2] * h, 0.5 * k[2] - 1.0, 1.0;
    return forms;
}

Mat33 adjugate(const Mat33& A) noexcept {
    Mat33 B;
    B.row(0) = A.col(1).cross(A.col(2)).transpose();
    B.row(1) = A.col(2).cross(A.col(0)).transpose();
    B.row(2) = A.col(0).cross(A.col(1)).transpose();
    return B;
}

/// Real zeros of x^3 + b x^2 + c x + d, polished. Returns how many.
int cubic_zeros(double b, double c, double d, std::array<double, 3>& zeros) noexcept {
    const double Q = (b * b - 3.0 * c) / 9.0, R = (b * (2.0 * b * b - 9.0 * c) + 27.0 * d) / 54.0;
    int count = 1;
    if (R * R < Q * Q * Q) {
        const double angle = std::acos(std::clamp(R / std::sqrt(Q * Q * Q), -1.0, 1.0));
        for (int k = 0; k < 3; ++k) {
            const double turn = angle + 2.0 * std::numbers::pi * k;
            zeros[static_cast<std::size_t>(k)] = -2.0 * std::sqrt(Q) * std::cos(turn / 3.0) - b / 3.0;
        }
        count = 3;
    } else {
        const double A = -std::copysign(std::cbrt(std::abs(R) + std::sqrt(std::max(0.0, R * R - Q * Q * Q))), R);
        zeros[0] = A + (A != 0.0 ? Q / A : 0.0) - b / 3.0;
    }
    for (int k = 0; k < count; ++k) {
        double& x = zeros[static_cast<std::size_t>(k)];
        for (int i = 0; i < 3; ++i) {
            const double slope = (3.0 * x + 2.0 * b) * x + c;
            if (slope != 0.0) x -= (((x + b) * x + c) * x + d) / slope;
        }
    }
    return count;
}

/// A singular member of a pencil of conics, and another member to intersect its lines with.
struct Member {
    Mat33 pair;
    Mat33 other;
};

/// Of the singular members of the pencil A + x B the one whose two lines cross most sharply; docs/pnp.md eq. (3).
Member singular_member(const Mat33& A, const Mat33& B) noexcept {
    const bool swap = std::abs(B.determinant()) < std::abs(A.determinant());
    const Mat33& P = swap ? B : A;
    const Mat33& Q = swap ? A : B;
    const double leading = Q.determinant();
    std::array<double, 3> zeros{};
    int count = 1;  // leading 0: both determinants are 0, and P is a pair itself
    if (leading != 0.0) {
        const double b = adjugate(Q).cwiseProduct(P).sum(), c = adjugate(P).cwiseProduct(Q).sum();
        count = cubic_zeros(b / leading, c / leading, P.determinant() / leading, zeros);
    }
    Member best{P, Q};
    double sharpest = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < count; ++k) {
        const double x = zeros[static_cast<std::size_t>(k)];
        const Mat33 C = P + x * Q;
        const double sharpness = -adjugate(C).diagonal().minCoeff() / C.squaredNorm();
        if (!(sharpness > sharpest)) continue;
        sharpest = sharpness;
        best = {C / C.norm(), std::abs(x) * Q.norm() < P.norm() ? Q : P};
    }
    return best;
}

/// Splits a singular conic into its lines g and h: C + hat(p) = 2 g h^T up to scale, p p^T = -adj C (Richter-Gebert
/// 2011, section 11.1).
void split(const Mat33& C, Vec3& g, Vec3& h) noexcept {
    const Mat33 B = adjugate(C);
    Eigen::Index i = 0;
    const double most = (-B.diagonal()).maxCoeff(&i);
    const Vec3 p = most > 0.0 ? Vec3(B.col(i) / std::sqrt(most)) : Vec3::Zero();
    const Mat33 N = C + so3::hat(p);
    Eigen::Index row = 0, column = 0;
    N.cwiseAbs().maxCoeff(&row, &column);
    g = N.col(column);
    h = N.row(row).transpose();
}

/// Where the line g^T e = 0 meets the conic e^T A e = 0, up to scale (twice the same where it touches). False if it
/// does not.
bool meet(const Vec3& g, const Mat33& A, std::array<Vec3, 2>& points) noexcept {
    const Vec3 u = g.unitOrthogonal(), v = g.cross(u).normalized();
    const double a = u.dot(A * u), b = u.dot(A * v), c = v.dot(A * v);
    const double discriminant = b * b - a * c;
    const double scale = std::max({a * a, b * b, c * c});
    if (!(discriminant > -1e-10 * scale)) return false;
    const double q = -(b + std::copysign(std::sqrt(std::max(0.0, discriminant)), b));
    // e = x u + y v with x : y = q : a or c : q, whichever pair does not vanish.
    points[0] = q * u + a * v;
    points[1] = c * u + q * v;
    return true;
}

/// Gives the depths their scale, then Newton's method on the three sides. False unless all sides fit and all depths are
/// positive.
bool polish(const Triangle& triangle, Vec3& d) noexcept {
    if (d.sum() < 0.0) d = -d;
    const double size = triangle.sides_at(d).sum(), wanted = triangle.squared_sides.norm();
    if (!(d.minCoeff() > 0.0) || !(size > 0.0)) return false;
    d *= std::sqrt(triangle.squared_sides.sum() / size);
    Vec3 error = triangle.sides_at(d) - triangle.squared_sides;
    for (int i = 0; i < kPolishing && error.norm() > 1e-15 * wanted; ++i) {
        const Vec3 next = d - triangle.derivative(d).inverse() * error;
        const Vec3 next_error = triangle.sides_at(next) - triangle.squared_sides;
        if (!(next_error.norm() < error.norm())) break;
        d = next;
        error = next_error;
    }
    return (error.cwiseAbs().array() <= kAgreement * triangle.squared_sides.array()).all() && d.minCoeff() > 0.0;
}

/// Right-handed axes of a triangle: along its first side, and its normal.
Mat33 axes(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    Mat33 R;
    R.col(0) = (b - a).normalized();
    R.col(2) = (b - a).cross(c - a).normalized();
    R.col(1) = R.col(2).cross(R.col(0));
    return R;
}

/// Both triangles, moved onto each other at their centroids.
SE3 pose_between(const std::array<Vec3, 3>& p, const std::array<Vec3, 3>& X) noexcept {
    SE3 T;
    T.R = axes(p[0], p[1], p[2]) * axes(X[0], X[1], X[2]).transpose();
    T.t = (p[0] + p[1] + p[2] - T.R * (X[0] + X[1] + X[2])) / 3.0;
    return T;
}

}  // namespace

int p3p(const std::array<Vec3, 3>& rays_camera, const std::array<Vec3, 3>& X_target,
        std::span<SE3, 4> T_camera_target) noexcept {
    const std::array<Vec3, 3> m{rays_camera[0].normalized(), rays_camera[1].normalized(), rays_camera[2].normalized()};
    const Vec3 a = X_target[1] - X_target[0], b = X_target[2] - X_target[0], c = X_target[2] - X_target[1];
    const Triangle triangle{
        .squared_sides = {a.squaredNorm(), b.squaredNorm(), c.squaredNorm()},
        .squared_chords = {(m[0] - m[1]).squaredNorm(), (m[0] - m[2]).squaredNorm(), (m[1] - m[2]).squaredNorm()}};
    const double longest = triangle.squared_sides.maxCoeff();
    if (!(a.cross(b).norm() > kCollinear * longest) || !std::isfinite(longest)) return 0;
    if (!(std::abs(m[0].dot(m[1].cross(m[2]))) > kCollinear * m[0].cross(m[1]).norm() * m[0].cross(m[2]).norm()))
        return 0;

    // Two forms that vanish at the depths sought, whatever their scale.
    const Vec3 s = triangle.squared_sides / longest;
    const double scale = std::sqrt(triangle.squared_chords.maxCoeff());
    const std::array<Mat33, 3> forms = side_forms(triangle.squared_chords, scale);
    const Member member = singular_member(s[2] * forms[0] - s[0] * forms[2], s[2] * forms[1] - s[1] * forms[2]);
    std::array<Vec3, 2> lines, points;
    split(member.pair, lines[0], lines[1]);
    int count = 0;
    for (const Vec3& line : lines) {
        if (!meet(line, member.other, points)) continue;
        for (const Vec3& e : points) {
            const double first = e[0] / scale;
            Vec3 d(first, first + e[1], first + e[2]);
            if (!polish(triangle, d)) continue;
            T_camera_target[static_cast<std::size_t>(count++)] =
                pose_between({d[0] * m[0], d[1] * m[1], d[2] * m[2]}, X_target);
        }
    }
    return count;
}

}  // namespace fairlead::pnp
