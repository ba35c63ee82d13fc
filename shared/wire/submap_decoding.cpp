#include <utility>

#include "shared/wire/cdr.hpp"
#include "shared/wire/columns.hpp"
#include "shared/wire/fields.hpp"
#include "shared/wire/submap_codec.hpp"
#include "shared/wire/submap_sample.hpp"

// Everything here reads a valid sample.
namespace fleetloc {
namespace {

Eigen::Quaterniond rotation(const std::vector<std::int32_t>& column, std::size_t row) {
  const std::int32_t* q = column.data() + 4 * row;
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

Eigen::Vector3d translation(const std::vector<std::int32_t>& column,
                            std::size_t row,
                            double units) {
  const std::int32_t* p = column.data() + 3 * row;
  return Eigen::Vector3d(p[0], p[1], p[2]) / units;
}

std::vector<SubmapKeyframe> keyframes(const wire::Submap& sample) {
  const Eigen::Vector3d origin = from_wire(sample.origin_odom());
  std::vector<SubmapKeyframe> out;
  out.reserve(sample.keyframe_id().size());
  for (std::size_t i = 0; i < sample.keyframe_id().size(); ++i) {
    out.push_back(
        {.id = KeyframeId{sample.keyframe_id()[i]},
         .revision = Revision{sample.keyframe_revision()[i]},
         .stamp = stamp_from_wire(sample.keyframe_stamp_ns()[i]),
         .T_odom_body = {rotation(sample.keyframe_rotation(), i),
                         origin +
                             translation(sample.keyframe_translation(), i, kKeyframeUnitsPerMetre)},
         .tilt_sigma = static_cast<double>(sample.keyframe_tilt_sigma()[i]),
         .observations = {}});
  }
  return out;
}

std::vector<VirtualEdge> edges(const wire::Submap& sample) {
  const std::span roots(sample.edge_information());
  std::vector<VirtualEdge> out;
  out.reserve(sample.edge_from().size());
  for (std::size_t i = 0; i < sample.edge_from().size(); ++i) {
    out.push_back({.from = KeyframeId{sample.keyframe_id()[sample.edge_from()[i]]},
                   .to = KeyframeId{sample.keyframe_id()[sample.edge_to()[i]]},
                   .revision = Revision{sample.edge_revision()[i]},
                   .T_from_to = {rotation(sample.edge_rotation(), i),
                                 translation(sample.edge_translation(), i, kEdgeUnitsPerMetre)},
                   .information = squared(roots.subspan(kRootSize * i).first<kRootSize>())});
  }
  return out;
}

std::vector<SubmapLandmark> landmarks(const wire::Submap& sample) {
  const Eigen::Vector3d origin = from_wire(sample.origin_odom());
  GapReader<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  std::vector<SubmapLandmark> out;
  out.reserve(sample.landmark_id().size());
  for (std::size_t i = 0; i < sample.landmark_id().size(); ++i) {
    const float* p = sample.landmark_position().data() + 3 * i;
    out.push_back({.id = LandmarkId{static_cast<std::uint32_t>(ids.next().value())},
                   .p_odom = origin + Eigen::Vector3f(p[0], p[1], p[2]).cast<double>()});
  }
  return out;
}

void add_observations(const wire::Submap& sample, Submap& submap) {
  GapReader<std::uint16_t> indices(sample.observation_landmark(),
                                   sample.observation_landmark_wide());
  std::size_t row = 0;
  for (std::size_t k = 0; k < submap.keyframes.size(); ++k) {
    indices.restart();
    std::vector<StereoObservation>& observations = submap.keyframes[k].observations;
    observations.reserve(sample.keyframe_observations()[k]);
    for (int i = 0; i < sample.keyframe_observations()[k]; ++i, ++row) {
      const auto landmark = static_cast<std::size_t>(indices.next().value());
      observations.push_back({.landmark = submap.landmarks[landmark].id,
                              .left = {sample.observation_left_u()[row] / kUnitsPerPixel,
                                       sample.observation_left_v()[row] / kUnitsPerPixel},
                              .disparity = sample.observation_disparity()[row] / kUnitsPerPixel});
    }
  }
}

}  // namespace

Decoded<Submap> decode_submap(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::Submap>(bytes, 1, check);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  Submap submap{.robot = sample.robot().to_string(),
                .session = SessionNumber{sample.session()},
                .incarnation = Incarnation{sample.incarnation()},
                .number = SampleNumber{sample.number()},
                .keyframes = keyframes(sample),
                .edges = edges(sample),
                .landmarks = landmarks(sample)};
  add_observations(sample, submap);
  return submap;
}

}  // namespace fleetloc
