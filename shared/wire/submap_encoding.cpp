#include <algorithm>
#include <string>
#include <vector>

#include "shared/model/camera.hpp"
#include "shared/wire/cdr.hpp"
#include "shared/wire/columns.hpp"
#include "shared/wire/fields.hpp"
#include "shared/wire/submap_codec.hpp"
#include "shared/wire/submap_sample.hpp"

namespace fleetloc {
namespace {

void append_rotation(const Eigen::Quaterniond& R, std::vector<std::int32_t>& column) {
  for (const double value : {R.w(), R.x(), R.y(), R.z()}) {
    column.push_back(quantized<std::int32_t>(value, kUnitsPerQuaternion, "a rotation"));
  }
}

void append_translation(const Eigen::Vector3d& p, double units, std::vector<std::int32_t>& column) {
  for (const double value : p) {
    column.push_back(quantized<std::int32_t>(value, units, "a translation"));
  }
}

std::uint16_t pixel_units(double px) {
  if (!(px >= 0.0 && px < kRectifiedSize)) {
    throw NotEncodable("a pixel of " + std::to_string(px));
  }
  constexpr double kMaxUnits = kRectifiedSize * kUnitsPerPixel - 1.0;  // when rounded up
  return static_cast<std::uint16_t>(std::min(std::round(px * kUnitsPerPixel), kMaxUnits));
}

std::uint16_t disparity_units(double px) {
  if (px == 0.0) return 0;
  return std::max(pixel_units(px), std::uint16_t{1});  // zero would mean: not seen
}

/// Index of the item with that id; throws NotEncodable if there is none. Sorted by id.
template <typename Item, typename Id>
std::size_t index_of(const std::vector<Item>& items, Id id, const char* what) {
  const auto item = std::ranges::lower_bound(items, id, {}, &Item::id);
  if (item == items.end() || item->id != id) throw NotEncodable(what);
  return static_cast<std::size_t>(item - items.begin());
}

/// The receiver would see any disorder but that of the landmarks themselves, for which indices are
/// searched; and an index that wraps around must not become another item.
void expect_searchable(const Submap& submap) {
  if (submap.keyframes.empty() || submap.keyframes.size() > 64) {
    throw NotEncodable("the number of keyframes");
  }
  if (submap.landmarks.size() > 8192) throw NotEncodable("the number of landmarks");
  if (!std::ranges::is_sorted(submap.keyframes, {}, &SubmapKeyframe::id)) {
    throw NotEncodable("keyframes out of order");
  }
  if (!std::ranges::is_sorted(submap.landmarks, {}, &SubmapLandmark::id)) {
    throw NotEncodable("landmarks out of order");
  }
}

void append_keyframes(const Submap& submap, wire::Submap& sample) {
  const Eigen::Vector3d origin = submap.keyframes.front().T_odom_body.p;
  sample.origin_odom(to_wire(origin));
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    if (keyframe.observations.size() > 16384) throw NotEncodable("the number of observations");
    sample.keyframe_id().push_back(static_cast<std::uint32_t>(keyframe.id));
    sample.keyframe_revision().push_back(static_cast<std::uint32_t>(keyframe.revision));
    sample.keyframe_stamp_ns().push_back(to_wire(keyframe.stamp));
    append_rotation(keyframe.T_odom_body.R, sample.keyframe_rotation());
    append_translation(
        keyframe.T_odom_body.p - origin, kKeyframeUnitsPerMetre, sample.keyframe_translation());
    sample.keyframe_tilt_sigma().push_back(static_cast<float>(keyframe.tilt_sigma));
    sample.keyframe_observations().push_back(
        static_cast<std::uint16_t>(keyframe.observations.size()));
  }
}

void append_edges(const Submap& submap, wire::Submap& sample) {
  constexpr auto kWhat = "an edge of a keyframe that is not in the submap";
  for (const VirtualEdge& edge : submap.edges) {
    sample.edge_from().push_back(
        static_cast<std::uint8_t>(index_of(submap.keyframes, edge.from, kWhat)));
    sample.edge_to().push_back(
        static_cast<std::uint8_t>(index_of(submap.keyframes, edge.to, kWhat)));
    sample.edge_revision().push_back(static_cast<std::uint32_t>(edge.revision));
    append_rotation(edge.T_from_to.R, sample.edge_rotation());
    append_translation(edge.T_from_to.p, kEdgeUnitsPerMetre, sample.edge_translation());
    const SquareRoot root = square_root_of(edge.information);
    sample.edge_information().insert(sample.edge_information().end(), root.begin(), root.end());
  }
}

void append_landmarks(const Submap& submap, wire::Submap& sample) {
  const Eigen::Vector3d origin = submap.keyframes.front().T_odom_body.p;
  GapWriter<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  for (const SubmapLandmark& landmark : submap.landmarks) {
    ids.push(static_cast<std::uint32_t>(landmark.id));
    for (const double value : Eigen::Vector3d(landmark.p_odom - origin)) {
      sample.landmark_position().push_back(static_cast<float>(value));
    }
  }
}

void append_observations(const Submap& submap, wire::Submap& sample) {
  GapWriter<std::uint16_t> landmarks(sample.observation_landmark(),
                                     sample.observation_landmark_wide());
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    landmarks.restart();
    for (const StereoObservation& observation : keyframe.observations) {
      landmarks.push(static_cast<std::int64_t>(
          index_of(submap.landmarks,
                   observation.landmark,
                   "an observation of a landmark that is not in the submap")));
      sample.observation_left_u().push_back(pixel_units(observation.left.x()));
      sample.observation_left_v().push_back(pixel_units(observation.left.y()));
      sample.observation_disparity().push_back(disparity_units(observation.disparity));
    }
  }
}

}  // namespace

Bytes encode(const Submap& submap) {
  expect_encodable_id(submap.robot);
  expect_searchable(submap);
  wire::Submap sample;
  sample.robot(submap.robot);
  sample.session(static_cast<std::uint32_t>(submap.session));
  sample.incarnation(static_cast<std::uint32_t>(submap.incarnation));
  sample.number(static_cast<std::uint32_t>(submap.number));
  append_keyframes(submap, sample);
  append_edges(submap, sample);
  append_landmarks(submap, sample);
  append_observations(submap, sample);
  expect_encodable(check(sample), "submap");  // as the receiver checks it
  return to_cdr(sample);
}

}  // namespace fleetloc
