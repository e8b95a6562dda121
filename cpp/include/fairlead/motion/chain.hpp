// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fairlead/motion/tie.hpp"
#include "fairlead/motion/white_jerk.hpp"
#include "fairlead/window/state.hpp"

namespace fairlead::motion {

/// All views on a smooth path so far, as one quadratic in the aligned shape u of the model and the aligned motion n =
/// (p, v, a) of the present moment,
///   E = 1/2 [u; n]^T Lambda [u; n] - eta^T [u; n],
/// earlier motion integrated out, docs/motion.md eq. (7)-(9). No function of it changes along the gauge of the model.
class Chain {
  public:
    Chain(const window::Reference& reference, int axes);

    /// Forgets the motion, keeps what is known of the shape.
    void restart() noexcept;
    /// Nothing is known, of the motion or of the shape.
    void clear() noexcept;
    /// The motion dt > 0 later.
    void predict(double dt, double density) noexcept;
    /// Less is known of the motion: as if the last dt had had this density besides.
    void loosen(double dt, double density) noexcept;
    /// Against time: what is known of the motion dt > 0 earlier from what is known now.
    void retrodict(double dt, double density) noexcept;
    /// Brings the slice to X, which the functions below then mean.
    void set_model(std::span<const Vec3> X) noexcept;
    /// Most likely motion for that model.
    [[nodiscard]] State expected_motion() const noexcept;
    /// Gradient with respect to the motion alone; its Hessian is motion_information().
    [[nodiscard]] State motion_gradient(const State& n) const noexcept;
    [[nodiscard]] const StateSquare& motion_information() const noexcept { return nn_; }
    /// d^2 E / du dn, in the slice's coordinates.
    [[nodiscard]] const ModelByState& coupling() const noexcept { return yn_; }
    /// The same with respect to X, at the model that was set.
    void pull_back(ModelByState& coupling) noexcept { slice_.pull_back(coupling); }

    /// Derivatives at that model and n; both triangles.
    void linearise(const State& n) noexcept;

    /// Takes in a view with its pose eliminated: A (dX dX), B (dX dn), C (dn dn) and gradients at that model and n.
    void absorb(const MatX& A, const Eigen::Ref<const ModelByState>& B, const StateSquare& C, const VecX& g_X,
                const State& g_n, const State& n) noexcept;

    /// The shape alone, motion integrated out.
    void marginal(MatX& Lambda, VecX& eta) noexcept;

    [[nodiscard]] int states() const noexcept { return 3 * axes_; }
    [[nodiscard]] const window::Slice& slice() const noexcept { return slice_; }
    [[nodiscard]] const window::GaugeBasis& gauge_rate_t() const noexcept { return rate_t_; }

    MatX H_XX;  ///< written by linearise(), like the next two
    ModelByState H_Xn;
    VecX g_X;

  private:
    void substitute(const StateSquare& M) noexcept;
    void diffuse(const StateSquare& L) noexcept;

    int axes_;
    window::Slice slice_;
    window::GaugeBasis rate_t_;
    MatX yy_;
    ModelByState yn_;
    StateSquare nn_;
    VecX eta_y_;
    State eta_n_;
    MatX scratch_;
    ModelByState wide_;
};

}  // namespace fairlead::motion
