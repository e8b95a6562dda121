// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
//
// Landmarks in, pose out: docs/ros.md section 3. No arithmetic but the covariance's convention; the core does the rest.

#include <tf2_ros/transform_broadcaster.h>

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fairlead/tracker.hpp>
#include <fairlead/window/landmark_prior.hpp>
#include <fstream>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <vision_msgs/msg/detection2_d_array.hpp>

#include "fairlead_ros/conversions.hpp"

namespace fairlead_ros {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using geometry_msgs::msg::PoseWithCovarianceStamped;
using geometry_msgs::msg::TransformStamped;
using sensor_msgs::msg::CameraInfo;
using vision_msgs::msg::Detection2DArray;

class TrackerNode : public rclcpp::Node {
  public:
    TrackerNode() : Node("fairlead"), broadcaster_(*this) {
        target_frame_ = declare_parameter<std::string>("target_frame", "target");
        std::ifstream table(declare_parameter<std::string>("target", ""));
        target_ = read_target(table);
        options_ = declare_options();
        pose_ = create_publisher<PoseWithCovarianceStamped>("~/pose", 10);
        diagnostics_ = create_publisher<DiagnosticArray>("/diagnostics", 10);
        camera_info_ = create_subscription<CameraInfo>("camera_info", rclcpp::SensorDataQoS(),
                                                       [this](const CameraInfo& info) { on_camera(info); });
        observations_ = create_subscription<Detection2DArray>(
            "observations", rclcpp::SensorDataQoS(), [this](const Detection2DArray& seen) { on_observations(seen); });
    }

  private:
    /// Every option of the core under its own name; its default is the core's.
    fairlead::TrackerOptions declare_options() {
        fairlead::TrackerOptions options;
        options.max_views = static_cast<int>(declare_parameter<std::int64_t>("max_views", options.max_views));
        options.loss_threshold = declare_parameter<double>("loss_threshold", options.loss_threshold);
        options.gate = declare_parameter<double>("gate", options.gate);
        options.min_inlier_ratio = declare_parameter<double>("min_inlier_ratio", options.min_inlier_ratio);
        options.coast_limit_s = declare_parameter<double>("coast_limit_s", options.coast_limit_s);
        options.max_step_rad = declare_parameter<double>("max_step_rad", options.max_step_rad);
        options.confirmations =
            static_cast<int>(declare_parameter<std::int64_t>("confirmations", options.confirmations));
        options.ambiguity_log_odds = declare_parameter<double>("ambiguity_log_odds", options.ambiguity_log_odds);
        options.motion = fairlead::motion::kind_named(
            declare_parameter<std::string>("motion", fairlead::motion::to_string(options.motion)));
        options.jerk_density_m_s25 = declare_parameter<double>("jerk_density_m_s25", options.jerk_density_m_s25);
        options.correlation_time_s = declare_parameter<double>("correlation_time_s", options.correlation_time_s);
        options.correlation_angle_rad =
            declare_parameter<double>("correlation_angle_rad", options.correlation_angle_rad);
        options.correlation_log_range =
            declare_parameter<double>("correlation_log_range", options.correlation_log_range);
        options.design_effect = declare_parameter<double>("design_effect", options.design_effect);
        options.range_to_origin = declare_parameter<bool>("range_to_origin", options.range_to_origin);
        options.range_bias_sigma_m = declare_parameter<double>("range_bias_sigma_m", options.range_bias_sigma_m);
        options.seed = static_cast<std::uint64_t>(
            declare_parameter<std::int64_t>("seed", static_cast<std::int64_t>(options.seed)));
        return options;
    }

    /// The first calibrated CameraInfo starts the tracker; later ones are those of the same camera.
    void on_camera(const CameraInfo& info) {
        if (tracker_ || info.k[0] == 0.0) return;
        try {
            const fairlead::Camera camera = camera_of(info.distortion_model, static_cast<int>(info.width),
                                                      static_cast<int>(info.height), info.k, info.d);
            tracker_.emplace(camera, target_.X0, fairlead::window::landmark_covariance(target_.X0, target_.sigma, 0.0),
                             options_);
        } catch (const std::invalid_argument& error) {
            RCLCPP_ERROR_THROTTLE(get_logger(), *get_clock(), 5000, "%s", error.what());
        }
    }

    void on_observations(const Detection2DArray& seen) {
        if (!tracker_) return;
        view_.clear();
        for (const auto& detection : seen.detections) {
            if (detection.results.empty()) continue;
            const auto& best = detection.results.front();
            const auto landmark = target_.number.find(best.hypothesis.class_id);
            if (landmark == target_.number.end()) continue;
            const auto& S = best.pose.covariance;
            const auto& centre = detection.bbox.center.position;
            view_.push_back({.landmark = landmark->second,
                             .z = {centre.x, centre.y},
                             .covariance = (fairlead::Mat22() << S[0], S[1], S[1], S[7]).finished()});
        }
        publish(seen.header, tracker_->update(nanoseconds(seen.header.stamp.sec, seen.header.stamp.nanosec), view_));
    }

    void publish(const std_msgs::msg::Header& header, const fairlead::Estimate& estimate) {
        diagnostics_->publish(diagnosis(header, estimate));
        if (!estimate.ok()) return;
        const Eigen::Quaterniond q(estimate.T_camera_target.R);
        const fairlead::Vec3& t = estimate.T_camera_target.t;
        PoseWithCovarianceStamped pose;
        pose.header = header;
        pose.pose.pose.position.x = t.x();
        pose.pose.pose.position.y = t.y();
        pose.pose.pose.position.z = t.z();
        pose.pose.pose.orientation.x = q.x();
        pose.pose.pose.orientation.y = q.y();
        pose.pose.pose.orientation.z = q.z();
        pose.pose.pose.orientation.w = q.w();
        pose.pose.covariance = ros_covariance(estimate);
        pose_->publish(pose);
        TransformStamped transform;
        transform.header = header;
        transform.child_frame_id = target_frame_;
        transform.transform.translation.x = t.x();
        transform.transform.translation.y = t.y();
        transform.transform.translation.z = t.z();
        transform.transform.rotation = pose.pose.pose.orientation;
        broadcaster_.sendTransform(transform);
    }

    static DiagnosticArray diagnosis(const std_msgs::msg::Header& header, const fairlead::Estimate& estimate) {
        DiagnosticStatus status;
        status.level = DiagnosticStatus::WARN;
        if (estimate.status == fairlead::Status::tracking) status.level = DiagnosticStatus::OK;
        if (estimate.status == fairlead::Status::lost) status.level = DiagnosticStatus::ERROR;
        status.name = "fairlead";
        status.message = fairlead::to_string(estimate.status);
        if (estimate.reason != fairlead::Reason::none)
            status.message += std::string(": ") + fairlead::to_string(estimate.reason);
        DiagnosticArray result;
        result.header.stamp = header.stamp;
        result.status.push_back(status);
        return result;
    }

    Target target_;
    std::string target_frame_;
    fairlead::TrackerOptions options_;
    std::optional<fairlead::Tracker> tracker_;
    std::vector<fairlead::Observation> view_;
    tf2_ros::TransformBroadcaster broadcaster_;
    rclcpp::Publisher<PoseWithCovarianceStamped>::SharedPtr pose_;
    rclcpp::Publisher<DiagnosticArray>::SharedPtr diagnostics_;
    rclcpp::Subscription<CameraInfo>::SharedPtr camera_info_;
    rclcpp::Subscription<Detection2DArray>::SharedPtr observations_;
};

}  // namespace fairlead_ros

int main(int argc, char** argv) {
    rclcpp::init(argc, argv);
    rclcpp::spin(std::make_shared<fairlead_ros::TrackerNode>());
    rclcpp::shutdown();
    return 0;
}
