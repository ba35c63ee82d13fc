#include "shared/compact/observation_predictor.hpp"

#include <algorithm>
#include <cstdint>

namespace fleetloc {
namespace {

constexpr int kMaxAveraged = 7;
constexpr double kMinDepth = 0.05;  // [m]; nearer ones are not predicted

StrictPose left_camera(const RectifiedStereo& stereo) {
  const auto& R = stereo.T_body_cam0.R;
  const auto& p = stereo.T_body_cam0.p;
  return {matrix_of(normalized({R.w(), R.x(), R.y(), R.z()})), {p.x(), p.y(), p.z()}};
}

}  // namespace

void LandmarkTrack::add(const CompactSubmap::Observation& observation,
                        std::size_t index,
                        double expected_disparity) {
  const double n = std::min(seen, kMaxAveraged);
  const double observed = observation.disparity;
  if (observation.disparity == 0) {
    disparity = expected_disparity;
  } else if (expected_disparity > 0.0) {
    disparity = (n * expected_disparity + observed) / (n + 1.0);
  } else {
    disparity = observed;
  }
  last = observation;
  keyframe = index;
  ++seen;
  misses = 0;
}

ObservationPredictor::ObservationPredictor(const RectifiedStereo& stereo,
                                           std::uint32_t step_bits,
                                           const std::vector<StrictPose>& bodies) {
  const auto steps_per_pixel = static_cast<double>(std::uint32_t{1} << step_bits);
  focal_ = stereo.focal_px * steps_per_pixel;
  center_u_ = stereo.center_px.x() * steps_per_pixel;
  center_v_ = stereo.center_px.y() * steps_per_pixel;
  baseline_ = stereo.baseline_m;
  max_steps_ = static_cast<int>(kRectifiedSize * steps_per_pixel) - 1;
  const StrictPose T_body_cam = left_camera(stereo);
  for (const StrictPose& body : bodies) {
    cameras_.push_back({product(body.R, T_body_cam.R), sum(body.p, product(body.R, T_body_cam.p))});
  }
}

PredictedObservation ObservationPredictor::predict(const LandmarkTrack& track,
                                                   std::size_t index) const {
  const StrictPose& from = cameras_[track.keyframe];
  const StrictPose& to = cameras_[index];
  const StrictVector ray{
      (track.last.u - center_u_) / focal_, (track.last.v - center_v_) / focal_, 1.0};
  const bool has_depth = track.disparity > 0.0;
  StrictVector p{};
  if (has_depth) {
    const double depth = focal_ * baseline_ / track.disparity;
    const StrictVector p_odom = sum(from.p, product(from.R, scaled(ray, depth)));
    p = transposed_product(to.R, difference(p_odom, to.p));
  } else {
    p = transposed_product(to.R, product(from.R, ray));
  }
  if (!(p[2] > kMinDepth)) return {track.last.u, track.last.v, track.disparity};
  return {.u = rounded(center_u_ + focal_ * p[0] / p[2], 0, max_steps_),
          .v = rounded(center_v_ + focal_ * p[1] / p[2], 0, max_steps_),
          .disparity = has_depth ? focal_ * baseline_ / p[2] : 0.0};
}

}  // namespace fleetloc
