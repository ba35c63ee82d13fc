#include "shared/compact/quantization.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/LU>

#include "shared/model/camera.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {
namespace {

constexpr int kMaxUnits = 1'000'000'000;
constexpr int kMaxDeviation = 100'000'000;
constexpr double kDeviationsPerSigma = 4.0;

StrictRotation strict(const Eigen::Quaterniond& R) {
  return {R.w(), R.x(), R.y(), R.z()};
}

Eigen::Vector3d vector_of(const StrictVector& v) {
  return {v[0], v[1], v[2]};
}

std::array<double, 3> position_of(const NewestPose& newest) {
  return {double{newest.p_odom[0]}, double{newest.p_odom[1]}, double{newest.p_odom[2]}};
}

std::int32_t steps(double px, double steps_per_pixel, int min) {
  if (!(px >= 0.0 && px < kRectifiedSize)) {
    throw NotEncodable("a pixel of " + std::to_string(px));
  }
  return rounded(px * steps_per_pixel, min, static_cast<int>(kRectifiedSize * steps_per_pixel) - 1);
}

std::vector<CompactSubmap::Observation> quantized(const SubmapKeyframe& keyframe,
                                                  const CompactSubmap& submap) {
  const auto steps_per_pixel = static_cast<double>(std::uint32_t{1} << submap.step_bits);
  std::vector<CompactSubmap::Observation> out;
  for (const StereoObservation& one : keyframe.observations) {
    if (!ObservationSubset{submap.stride, submap.offset}.has(one.landmark, keyframe.id)) continue;
    out.push_back(
        {.landmark = static_cast<std::uint32_t>(one.landmark),
         .u = steps(one.left.x(), steps_per_pixel, 0),
         .v = steps(one.left.y(), steps_per_pixel, 0),
         .disparity = one.disparity > 0.0 ? steps(one.disparity, steps_per_pixel, 1) : 0});
  }
  if (out.size() > CompactSubmap::kMaxObservations) throw NotEncodable("too many observations");
  return out;
}

// From the newest keyframe backwards: each turn is taken from the pose that the receiver has, so
// errors do not add up.
void quantize_poses(const Submap& submap, const NewestPose& newest, CompactSubmap& out) {
  StrictRotation newer = out.newest_rotation;
  const Eigen::Vector3d origin = vector_of(position_of(newest));
  for (std::size_t i = submap.keyframes.size(); i-- > 0;) {
    const SubmapKeyframe& keyframe = submap.keyframes[i];
    CompactSubmap::Keyframe& coded = out.keyframes[i];
    if (i + 1 == submap.keyframes.size()) continue;
    coded.turn = turn_of(product(conjugate(newer), strict(keyframe.T_odom_body.R.normalized())),
                         CompactSubmap::kUnitsPerQuaternion);
    newer = normalized(product(newer, rotation_of(coded.turn, CompactSubmap::kUnitsPerQuaternion)));
    const Eigen::Vector3d units = (keyframe.T_odom_body.p - origin) / CompactSubmap::kMetresPerUnit;
    if (!(units.cwiseAbs().maxCoeff() < kMaxUnits)) throw NotEncodable("a keyframe's position");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coded.position[axis] = rounded(units[static_cast<Eigen::Index>(axis)], -kMaxUnits, kMaxUnits);
    }
  }
}

std::uint32_t index_of(const Submap& submap, KeyframeId id) {
  const auto place = std::ranges::lower_bound(submap.keyframes, id, {}, &SubmapKeyframe::id);
  if (place == submap.keyframes.end() || place->id != id) {
    throw NotEncodable("an edge of a keyframe that is not in the submap");
  }
  return static_cast<std::uint32_t>(place - submap.keyframes.begin());
}

Eigen::Matrix3d matrix_of_pose(const StrictPose& pose) {
  Eigen::Matrix3d R;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      R(row, column) = pose.R[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
  }
  return R;
}

CompactSubmap::Edge quantized(const VirtualEdge& edge,
                              const Submap& submap,
                              const std::vector<StrictPose>& poses) {
  CompactSubmap::Edge out{.from = index_of(submap, edge.from), .to = index_of(submap, edge.to)};
  const Eigen::Matrix3d R_from = matrix_of_pose(poses[out.from]);
  const Eigen::Matrix3d R_to = matrix_of_pose(poses[out.to]);
  Matrix6d axes = Matrix6d::Zero();  // of odom
  axes.topLeftCorner<3, 3>() = axes.bottomRightCorner<3, 3>() = R_to;
  const Matrix6d covariance = axes * edge.information.inverse() * axes.transpose();
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) {
    throw NotEncodable("an edge's information");
  }
  const auto variance = covariance.diagonal();
  out.sigma = {SigmaCode::nearest(std::sqrt(variance.head<3>().mean())),
               SigmaCode::nearest(std::sqrt(variance.segment<2>(3).mean())),
               SigmaCode::nearest(std::sqrt(variance(5)))};

  const Eigen::Quaterniond turned(R_from.transpose() * R_to);
  const Eigen::Quaterniond error = turned.conjugate() * edge.T_from_to.R;
  const Eigen::Vector3d rotation = R_to * (2.0 / error.w() * error.vec());
  const Eigen::Vector3d moved = vector_of(difference(poses[out.to].p, poses[out.from].p));
  const Eigen::Vector3d translation = R_from * edge.T_from_to.p - moved;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    const std::size_t kind = i < 3 ? 0 : i < 5 ? 1 : 2;
    const double unit = SigmaCode::sigma(out.sigma[kind]) / kDeviationsPerSigma;
    out.deviation[i] =
        rounded((i < 3 ? rotation : translation)[axis] / unit, -kMaxDeviation, kMaxDeviation);
  }
  return out;
}

VirtualEdge edge_of(const CompactSubmap::Edge& edge,
                    const CompactSubmap& coded,
                    const std::vector<StrictPose>& poses,
                    const std::vector<StrictRotation>& rotations) {
  const StrictPose& from = poses[edge.from];
  const StrictPose& to = poses[edge.to];
  std::array<double, 3> sigma{};
  for (std::size_t i = 0; i < 3; ++i) sigma[i] = SigmaCode::sigma(edge.sigma[i]);
  StrictVector rotation{};
  StrictVector translation{};
  for (std::size_t i = 0; i < 3; ++i) {
    rotation[i] = edge.deviation[i] * (sigma[0] / kDeviationsPerSigma);
    translation[i] = edge.deviation[i + 3] * (sigma[i < 2 ? 1 : 2] / kDeviationsPerSigma);
  }
  const StrictVector half = scaled(transposed_product(to.R, rotation), 0.5);
  const StrictRotation turned = product(conjugate(rotations[edge.from]), rotations[edge.to]);
  const StrictRotation q = normalized(product(turned, {1.0, half[0], half[1], half[2]}));
  const StrictVector p = transposed_product(from.R, sum(difference(to.p, from.p), translation));

  const double rotational = 1.0 / (sigma[0] * sigma[0]);
  const double horizontal = 1.0 / (sigma[1] * sigma[1]);
  const double vertical = 1.0 / (sigma[2] * sigma[2]) - horizontal;
  const StrictVector& up = to.R[2];  // in the body's axes
  VirtualEdge out{.from = KeyframeId{coded.keyframes[edge.from].id},
                  .to = KeyframeId{coded.keyframes[edge.to].id},
                  .revision = {},
                  .T_from_to = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]), vector_of(p)},
                  .information = Matrix6d::Zero()};
  for (int row = 0; row < 3; ++row) {
    out.information(row, row) = rotational;
    for (int column = 0; column < 3; ++column) {
      out.information(3 + row, 3 + column) =
          vertical * (up[static_cast<std::size_t>(row)] * up[static_cast<std::size_t>(column)]) +
          (row == column ? horizontal : 0.0);
    }
  }
  return out;
}

std::vector<StrictRotation> rotations_of(const CompactSubmap& coded) {
  std::vector<StrictRotation> out(coded.keyframes.size(), coded.newest_rotation);
  for (std::size_t i = coded.keyframes.size() - 1; i-- > 0;) {
    out[i] = normalized(product(
        out[i + 1], rotation_of(coded.keyframes[i].turn, CompactSubmap::kUnitsPerQuaternion)));
  }
  return out;
}

SubmapKeyframe keyframe_of(const CompactSubmap::Keyframe& coded, double step_px) {
  SubmapKeyframe out{.id = KeyframeId{coded.id},
                     .revision = {},
                     .stamp = {},
                     .T_odom_body = {},
                     .tilt_sigma = kUnknownTiltRad,
                     .pixel_step_px = step_px,
                     .subset = {},
                     .observations = {}};
  if (coded.tilt != CompactSubmap::kUnknownTilt) {
    out.tilt_sigma = std::min(SigmaCode::sigma(coded.tilt), kUnknownTiltRad);
  }
  for (const CompactSubmap::Observation& one : coded.observations) {
    out.observations.push_back({.landmark = LandmarkId{one.landmark},
                                .left = {one.u * step_px, one.v * step_px},
                                .disparity = one.disparity * step_px});
  }
  return out;
}

}  // namespace

NewestPose newest_pose(const Submap& submap) {
  const Pose& T = submap.keyframes.back().T_odom_body;
  const Eigen::Quaterniond R = T.R.normalized();
  NewestPose out;
  const StrictRotation q = strict(R.w() < 0.0 ? Eigen::Quaterniond(-R.coeffs()) : R);
  for (std::size_t i = 0; i < 4; ++i) {
    out.rotation[i] =
        static_cast<std::int16_t>(rounded(q[i] * NewestPose::kUnitsPerQuaternion, -16384, 16384));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    out.p_odom[i] = static_cast<float>(T.p[static_cast<Eigen::Index>(i)]);
  }
  return out;
}

StrictRotation rotation_of(const NewestPose& pose) {
  StrictRotation q{};
  for (std::size_t i = 0; i < 4; ++i) q[i] = pose.rotation[i] / NewestPose::kUnitsPerQuaternion;
  return normalized(q);
}

CompactSubmap quantized(const Submap& submap,
                        const NewestPose& newest,
                        ObservationSubset subset,
                        std::uint32_t step_bits) {
  if (submap.keyframes.empty() || submap.keyframes.size() > CompactSubmap::kMaxKeyframes ||
      submap.edges.size() > CompactSubmap::kMaxEdges) {
    throw NotEncodable("the number of keyframes or edges");
  }
  CompactSubmap out;
  out.newest_rotation = rotation_of(newest);
  out.stride = subset.stride;
  out.offset = subset.offset;
  out.step_bits = step_bits;
  out.keyframes.resize(submap.keyframes.size());
  const Timestamp stamp = submap.keyframes.back().stamp;
  for (std::size_t i = 0; i < submap.keyframes.size(); ++i) {
    const SubmapKeyframe& keyframe = submap.keyframes[i];
    CompactSubmap::Keyframe& coded = out.keyframes[i];
    const std::int64_t unit = CompactSubmap::kNanosecondsPerUnit;
    const std::int64_t age = ((stamp - keyframe.stamp).count() + unit / 2) / unit;
    if (age < 0 || age > kMaxUnits) throw NotEncodable("a keyframe's stamp");
    coded.id = static_cast<std::uint32_t>(keyframe.id);
    coded.age = static_cast<std::int32_t>(age);
    coded.has_observations = !keyframe.is_reference;
    if (keyframe.is_reference) continue;
    if (keyframe.tilt_sigma < kUnknownTiltRad) coded.tilt = SigmaCode::nearest(keyframe.tilt_sigma);
    coded.observations = quantized(keyframe, out);
  }
  quantize_poses(submap, newest, out);
  const std::vector<StrictPose> poses = poses_of(out);
  for (const VirtualEdge& edge : submap.edges) out.edges.push_back(quantized(edge, submap, poses));
  std::ranges::sort(out.edges, {}, [](const auto& edge) { return std::pair(edge.to, edge.from); });
  return out;
}

Submap submap_of(const CompactSubmap& coded,
                 const NewestPose& newest,
                 Timestamp stamp,
                 SampleNumber number) {
  const Revision revision = revision_of(number);
  const double step_px = 1.0 / static_cast<double>(std::uint32_t{1} << coded.step_bits);
  const std::vector<StrictPose> poses = poses_of(coded);
  const std::vector<StrictRotation> rotations = rotations_of(coded);
  const StrictVector origin = position_of(newest);
  Submap out;
  for (std::size_t i = 0; i < coded.keyframes.size(); ++i) {
    const CompactSubmap::Keyframe& keyframe = coded.keyframes[i];
    if (!keyframe.has_observations) continue;
    SubmapKeyframe one = keyframe_of(keyframe, step_px);
    one.revision = revision;
    one.subset = {coded.stride, coded.offset};
    one.stamp = stamp - Duration{keyframe.age * CompactSubmap::kNanosecondsPerUnit};
    const StrictRotation& q = rotations[i];
    one.T_odom_body = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                       vector_of(sum(origin, poses[i].p))};
    out.keyframes.push_back(std::move(one));
  }
  for (const CompactSubmap::Edge& edge : coded.edges) {
    out.edges.push_back(edge_of(edge, coded, poses, rotations));
    out.edges.back().revision = revision;
  }
  return out;
}

}  // namespace fleetloc
