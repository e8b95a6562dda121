// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "fairlead/motion/chain.hpp"
#include "fairlead/motion/density.hpp"
#include "fairlead/window/problem.hpp"

namespace fairlead::motion {

/// The smooth path of camera or target in time, and the newest view on it.
///
/// advance() to the view's stamp; join() adds everything older than the view and the view itself to the structure's
/// system, pose and motion of the view eliminated; step() gives their steps; settle() makes the view part of the past.
/// The past is kept and gone through again, a few views an update, at the model as it has become: a view that was
/// linearised at a poor model would hold on to it. docs/motion.md section 3.
class Path {
  public:
    static constexpr std::size_t kKept = 1024;  ///< views of the past that are gone through again

    Path(Kind kind, double density, const window::Reference& reference, std::size_t kept = kKept);

    void restart() noexcept;
    void advance(std::int64_t stamp_ns, std::span<const Vec3> X, const std::optional<Attitude>& attitude) noexcept;

    /// S and g are those of E; the view is linearised at X with its state factored. False if the system is singular.
    [[nodiscard]] bool join(const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor, MatX& S,
                            VecX& g) noexcept;
    /// Step of the view's pose for a step of the structure; the motion takes its own.
    [[nodiscard]] Vec6 step(const VecX& dX) noexcept;
    /// Twice the decrease of E that pose and motion bring by themselves.
    [[nodiscard]] double decrease() const noexcept { return y_.squaredNorm(); }
    /// Of the view's pose as last joined, the structure's uncertainty in it.
    [[nodiscard]] Mat66 covariance(const window::ViewBlock& view, const window::Problem& problem,
                                   const MatX& Sigma) noexcept;

    /// Takes the newest view as last joined; gives back a view block that is free again.
    [[nodiscard]] window::ViewBlock settle(window::ViewBlock&& view, const window::Problem& problem) noexcept;
    /// What the path says of the model's shape.
    void marginal(MatX& Lambda, VecX& eta) noexcept { chain_.marginal(Lambda, eta); }

    /// A batch instead, for which `kept` must have room: views in the order of their stamps, each linearised and with a
    /// pose of its own. False, the view left as it was, if nothing ties it to the path.
    [[nodiscard]] bool append(window::ViewBlock& view, const std::optional<Attitude>& attitude,
                              const window::Problem& problem) noexcept;
    /// All of them once backwards and once forwards, poses and motions fitted to the model as it is.
    void smooth(const window::Problem& problem) noexcept;
    /// Of their poses, the structure's uncertainty in them; docs/motion.md eq. (14). Allocates.
    [[nodiscard]] std::vector<Mat66> covariances(const window::Problem& problem, const MatX& Sigma);
    [[nodiscard]] const window::ViewBlock& view(std::size_t i) const noexcept {
        return past_[(first_ + i) % past_.size()].view;
    }

    /// d |centroid in the camera| / dt [m/s].
    [[nodiscard]] double range_rate() const noexcept;
    [[nodiscard]] double density() const noexcept { return bank_.density(); }

  private:
    static constexpr int kMaxJoint = 6 + kMaxState;
    static constexpr double kMaxInterval = 10.0;  ///< [s] without a view after which the motion begins anew
    using Joint = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoint, 1>;
    using JointSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoint, kMaxJoint>;
    using ModelByJoint = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Eigen::Dynamic, kMaxJoint>;

    struct Past {
        window::ViewBlock view;
        double interval_s = 0.0;  ///< since the one before
        double density = 0.0;
        std::optional<Attitude> attitude;
        Vec3 position = Vec3::Zero();  ///< that the view alone gives, and its information
        Mat33 information = Mat33::Zero();
        StateSquare later_information;  ///< of the motion, from the views after this one: Lambda and Lambda n
        State later;
    };

    void tie(const Chain& chain, const SE3& T, std::span<const Vec3> X, const std::optional<Attitude>& attitude,
             const State& n) noexcept;
    /// Hessian and gradient of pose and motion of a view, model held.
    void motion_system(const Chain& chain, const window::ViewBlock& view, double noise_factor, const State& n,
                       JointSquare& H, Joint& h) const noexcept;
    void add_view(const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor, MatX& S,
                  VecX& g) noexcept;
    void absorb(Chain& chain, const window::ViewBlock& view, std::span<const Vec3> X, double noise_factor,
                const State& n) noexcept;
    /// The position that the view alone gives, at the tie as last measured; false if it gives none.
    [[nodiscard]] bool own_position(const window::ViewBlock& view, double noise_factor, Vec3& position,
                                    Mat33& covariance) const noexcept;
    /// What is known besides of the motion of a view that is eliminated: information, and coupling to X.
    struct Later {
        StateSquare nn;
        ModelByState Xn;
    };
    [[nodiscard]] bool eliminate(const Chain& chain, const window::ViewBlock& view, std::span<const Vec3> X,
                                 double noise_factor, const State& n, const Later* later, MatX& S, VecX& g) noexcept;
    static void forward(Chain& chain, const Past& past) noexcept;
    [[nodiscard]] std::vector<Later> later_knowledge(const window::Problem& problem);
    void retrace(Chain& chain, Past& past, const window::Problem& problem) noexcept;
    void look_back(std::size_t i) noexcept;
    void catch_up() noexcept;
    void go_through_some(const window::Problem& problem) noexcept;
    void keep(window::ViewBlock& view, const window::Problem& problem) noexcept;
    [[nodiscard]] Past& past(std::size_t i) noexcept { return past_[(first_ + i) % past_.size()]; }

    Kind kind_;
    int axes_;
    Chain chain_;  ///< up to the newest view
    Chain base_;   ///< before the first view that is kept
    Chain anew_;   ///< on the way from base_ to the newest view
    std::vector<Past> past_;
    std::size_t first_ = 0, kept_ = 0;
    std::size_t retraced_ = 0;      ///< views that anew_ has
    std::size_t to_look_back_ = 0;  ///< views that the look back has before it

    DensityBank bank_;
    Tie tie_;
    bool tied_ = false;
    std::optional<Attitude> attitude_;
    std::int64_t stamp_ns_ = 0;
    bool started_ = false;
    double interval_s_ = 0.0, density_ = 0.0;
    double loosened_ = 0.0;  ///< density that the chain was given lately

    State n_;
    Vec3 residual_ = Vec3::Zero();  ///< of the tie
    JointSquare L_inverse_;
    Joint y_;
    ModelByJoint rows_t_;  ///< dX d(pose, motion)
    ModelByJoint Y_t_, SigmaY_t_;
    MatX A_;
    VecX b_;
};

}  // namespace fairlead::motion
