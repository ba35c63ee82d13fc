// Writes samples of the compact encoding, each with the submap that they are decoded to: a line of
// JSON each, doubles in hexadecimal. decode_submap.py has to come to the same.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/compact/submap_sample.hpp"
#include "test/unit/compact/moving_robot.hpp"

namespace fleetloc {
namespace {

using nlohmann::json;

std::string text(double value) {
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

json rotation(const Eigen::Quaterniond& q) {
  return texts(std::vector{q.w(), q.x(), q.y(), q.z()});
}

json vector(const Eigen::Vector3d& v) {
  return texts(std::vector{v.x(), v.y(), v.z()});
}

json stereo_json(const RectifiedStereo& stereo) {
  return {{"focal_px", text(stereo.focal_px)},
          {"center_px", texts(std::vector{stereo.center_px.x(), stereo.center_px.y()})},
          {"baseline_m", text(stereo.baseline_m)},
          {"rotation", rotation(stereo.T_body_cam0.R)},
          {"translation", vector(stereo.T_body_cam0.p)}};
}

json keyframe_json(const SubmapKeyframe& keyframe) {
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

json edge_json(const VirtualEdge& edge) {
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

json submap_json(const Submap& submap) {
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

std::string hexadecimal(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    out += digits;
  }
  return out;
}

/// Windows of a drive: of one keyframe to ten, whole and halved, some with keyframes that only
/// edges need, and with an edge over many keyframes.
Submap window_of(const Submap& drive, std::uint32_t number) {
  Submap window;
  window.robot = drive.robot;
  window.number = SampleNumber{number};
  const std::size_t size = 1 + number % 10;
  for (std::size_t i = 0; i < size; ++i) {
    window.keyframes.push_back(drive.keyframes[number + i]);
    if (i > 0) window.edges.push_back(drive.edges[number + i - 1]);
    window.keyframes.back().is_reference = number % 3 == 0 && i + 2 < size;
    if (number % 7 == 0) window.keyframes.back().tilt_sigma = kUnknownTiltRad;
  }
  if (size > 4) {
    VirtualEdge wide = window.edges.front();
    wide.to = window.keyframes.back().id;
    wide.T_from_to =
        inverse(window.keyframes.front().T_odom_body) * window.keyframes.back().T_odom_body;
    window.edges.push_back(wide);
  }
  return window;
}

void write_vectors(std::ostream& out) {
  const RectifiedStereo stereo = some_stereo();
  Submap drive = moving_robot(100, 80);
  for (SubmapKeyframe& keyframe : drive.keyframes) {
    if (keyframe.observations.size() > 50) keyframe.observations.resize(50);
  }
  for (std::uint32_t number = 0; number < 60; ++number) {
    const std::uint32_t stride = 1 + number % 2;
    const CompactPrecision precision{.subset = {.stride = stride, .offset = number / 2 % stride},
                                     .step_bits = number % 4};
    const Bytes bytes = encode_compact(window_of(drive, number), {}, precision, stereo);
    const Submap decoded = decode_submap(decode_submap_sample(bytes).value(), stereo).value();
    out << json{{"stereo", stereo_json(stereo)},
                {"sample", hexadecimal(bytes)},
                {"submap", submap_json(decoded)}}
               .dump()
        << '\n';
  }
}

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: compact_vectors FILE\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  fleetloc::write_vectors(out);
  out.close();
  return out ? 0 : 1;
}
