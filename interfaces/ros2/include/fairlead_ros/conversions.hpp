// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <fairlead/tracker.hpp>
#include <istream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// What the node needs beside ROS and the core; nothing of ROS in here.
namespace fairlead_ros {

/// Landmarks of a target: X ~ N(X0, diag(sigma^2)).
struct Target {
    std::vector<std::string> names;
    std::vector<fairlead::Vec3> X0;     // [m]
    std::vector<fairlead::Vec3> sigma;  // [m]
    std::map<std::string, int> number;
};

/// A table name,x_m,y_m,z_m,sigma_m with that first line. Throws std::invalid_argument with the line.
inline Target read_target(std::istream& stream) {
    Target target;
    std::string line;
    if (!std::getline(stream, line) || line != "name,x_m,y_m,z_m,sigma_m")
        throw std::invalid_argument("target: expected the first line name,x_m,y_m,z_m,sigma_m, got '" + line + "'");
    for (int count = 2; std::getline(stream, line); ++count) {
        if (line.empty()) continue;
        std::istringstream cells(line);
        std::string name;
        std::array<double, 4> numbers{};
        std::getline(cells, name, ',');
        for (double& number : numbers) {
            std::string cell;
            std::size_t used = 0;
            if (std::getline(cells, cell, ',')) number = std::stod(cell, &used);
            if (used == 0 || used != cell.size() || !std::isfinite(number))
                throw std::invalid_argument("target, line " + std::to_string(count) +
                                            ": expected a name and 4 numbers");
        }
        if (name.empty() || !target.number.emplace(name, static_cast<int>(target.names.size())).second)
            throw std::invalid_argument("target, line " + std::to_string(count) + ": name missing or twice");
        target.names.push_back(name);
        target.X0.emplace_back(numbers[0], numbers[1], numbers[2]);
        target.sigma.push_back(fairlead::Vec3::Constant(numbers[3]));
    }
    return target;
}

/// The camera of a CameraInfo: K row by row. Throws std::invalid_argument for a model that is not known.
inline fairlead::Camera camera_of(const std::string& model, int width, int height, const std::array<double, 9>& k,
                                  std::vector<double> d) {
    using fairlead::CameraModel;
    static const std::map<std::string, CameraModel> models = {{"", CameraModel::pinhole},
                                                              {"plumb_bob", CameraModel::plumb_bob},
                                                              {"rational_polynomial", CameraModel::rational},
                                                              {"equidistant", CameraModel::equidistant},
                                                              {"fisheye", CameraModel::equidistant}};
    const auto found = models.find(model);
    if (found == models.end()) throw std::invalid_argument("camera_info: unknown distortion model '" + model + "'");
    const fairlead::Mat33 K = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(k.data());
    d.resize(static_cast<std::size_t>(fairlead::distortion_size(found->second)), 0.0);
    return fairlead::make_camera(found->second, width, height, K, d);
}

/// S_ros = B S B^T, B = blkdiag(R, R), row by row: docs/ros.md eq. (1).
inline std::array<double, 36> ros_covariance(const fairlead::Estimate& estimate) {
    fairlead::Mat66 B = fairlead::Mat66::Zero();
    B.topLeftCorner<3, 3>() = estimate.T_camera_target.R;
    B.bottomRightCorner<3, 3>() = estimate.T_camera_target.R;
    std::array<double, 36> result{};
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(result.data()) = B * estimate.covariance * B.transpose();
    return result;
}

/// [ns].
inline std::int64_t nanoseconds(std::int32_t sec, std::uint32_t nanosec) {
    return std::int64_t{sec} * 1'000'000'000 + std::int64_t{nanosec};
}

}  // namespace fairlead_ros
