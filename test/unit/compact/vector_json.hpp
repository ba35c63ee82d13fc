#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/model/camera.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

// What samples are decoded to, with every bit: doubles are written in hexadecimal.

using nlohmann::json;

inline std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%a", value);
  return buffer;
}

template <typename Values>
json texts(const Values& values) {
  json out = json::array();
  for (const double value : values) out.push_back(text(value));
  return out;
}

inline json rotation(const Eigen::Quaterniond& q) {
  return texts(std::vector{q.w(), q.x(), q.y(), q.z()});
}

inline json vector(const Eigen::Vector3d& v) {
  return texts(std::vector{v.x(), v.y(), v.z()});
}

inline json stereo_json(const RectifiedStereo& stereo) {
  return {{"focal_px", text(stereo.focal_px)},
          {"center_px", texts(std::vector{stereo.center_px.x(), stereo.center_px.y()})},
          {"baseline_m", text(stereo.baseline_m)},
          {"rotation", rotation(stereo.T_body_cam0.R)},
          {"translation", vector(stereo.T_body_cam0.p)}};
}

inline json keyframe_json(const SubmapKeyframe& keyframe) {
  json observations = json::array();
  for (const StereoObservation& one : keyframe.observations) {
    observations.push_back({static_cast<std::uint32_t>(one.landmark),
                            text(one.left.x()),
                            text(one.left.y()),
                            text(one.disparity)});
  }
  return {{"id", static_cast<std::uint32_t>(keyframe.id)},
          {"stamp_ns", keyframe.stamp.time_since_epoch().count()},
          {"rotation", rotation(keyframe.T_odom_body.R)},
          {"position", vector(keyframe.T_odom_body.p)},
          {"tilt_sigma", text(keyframe.tilt_sigma)},
          {"observations", observations}};
}

inline json edge_json(const VirtualEdge& edge) {
  std::vector<double> translational;
  for (int row = 3; row < 6; ++row) {
    for (int column = 3; column < 6; ++column) {
      translational.push_back(edge.information(row, column));
    }
  }
  return {{"from", static_cast<std::uint32_t>(edge.from)},
          {"to", static_cast<std::uint32_t>(edge.to)},
          {"rotation", rotation(edge.T_from_to.R)},
          {"translation", vector(edge.T_from_to.p)},
          {"rotational", text(edge.information(0, 0))},
          {"translational", texts(translational)}};
}

inline json submap_json(const Submap& submap) {
  json keyframes = json::array();
  json edges = json::array();
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    keyframes.push_back(keyframe_json(keyframe));
  }
  for (const VirtualEdge& edge : submap.edges) edges.push_back(edge_json(edge));
  return {{"robot", submap.robot},
          {"number", static_cast<std::uint32_t>(submap.number)},
          {"keyframes", keyframes},
          {"edges", edges}};
}

template <int N>
json upper_triangle(const Eigen::Matrix<double, N, N>& matrix) {
  json out = json::array();
  for (int row = 0; row < N; ++row) {
    for (int column = row; column < N; ++column) out.push_back(text(matrix(row, column)));
  }
  return out;
}

inline json correction_json(const Correction& correction) {
  json poses = json::array();
  for (const auto& pose : correction.relative_poses) {
    poses.push_back({{"from", static_cast<std::uint32_t>(pose.from)},
                     {"to", static_cast<std::uint32_t>(pose.to)},
                     {"rotation", rotation(pose.T_from_to.R)},
                     {"translation", vector(pose.T_from_to.p)},
                     {"information", upper_triangle<6>(pose.information)}});
  }
  json landmarks = json::array();
  for (const auto& landmark : correction.landmarks) {
    landmarks.push_back({{"id", static_cast<std::uint32_t>(landmark.id)},
                         {"p_anchor", vector(landmark.p_anchor)},
                         {"information", upper_triangle<3>(landmark.information)}});
  }
  return {{"relative_poses", poses}, {"landmarks", landmarks}};
}

}  // namespace fleetloc
