#include "robot/fusion/coupled_fusion.hpp"

#include <cassert>
#include <utility>

namespace fleetloc {

CoupledFusion::CoupledFusion(const ImuNoise& noise, const Config& config)
    : config_(config), frames_(noise, config), newest_(config.answers) {}

// The filter's map pose hangs on the odometry's frame: it starts over.
void CoupledFusion::reset(SessionNumber session,
                          const std::optional<MapOdomEstimate>& /*carried*/) {
  frames_.reset(session);
  interrupted_ = false;
  stops_.clear();
  newest_ = MapBodyFilter(config_.answers);
  map_prediction_.reset();
}

PoseEstimate CoupledFusion::add_imu(const ImuSample& sample) {
  if (frames_.add_imu(sample)) {
    if (map_prediction_) {
      advance(*map_prediction_, *frames_.previous_imu(), sample, frames_.noise());
    }
    reach_frames();
  }
  if (frames_.prediction() && !stops_.empty()) {
    return estimate(*frames_.prediction(), map_prediction_, newest_);
  }
  PoseEstimate nothing;
  nothing.stamp = frames_.last_imu() ? frames_.last_imu()->stamp : sample.stamp;
  return nothing;
}

PoseFusion::Verdict CoupledFusion::add_odometry(const OdometryEstimate& estimate) {
  if (const std::string_view reason = frames_.add_odometry(estimate); !reason.empty()) {
    return {.applied = false, .reason = reason};
  }
  reach_frames();
  while (frames_.has_stale() && stops_.size() > 1) {
    frames_.forget_oldest();
    stops_.pop_front();
  }
  return {.applied = true, .reason = "applied"};
}

// Preintegrated about the odometry's biases, so that it does not depend on what arrived when.
void CoupledFusion::reach_frames() {
  const std::size_t before = stops_.size();
  while (stops_.size() < frames_.size()) {
    const std::size_t next = stops_.size();
    const OdometryEstimate& frame = frames_[next].odometry;
    if (!frames_.last_imu() || frame.stamp > frames_.last_imu()->stamp) {
      break;
    }
    Stop stop{.from_previous = std::nullopt, .filter = MapBodyFilter(config_.answers)};
    if (next > 0) {
      const OdometryEstimate& previous = frames_[next - 1].odometry;
      const std::vector<ImuSample> samples = frames_.imu().between(previous.stamp, frame.stamp);
      if (samples.size() > 1) {
        stop.from_previous.emplace(samples, previous.state.bias, frames_.noise());
      }
    }
    stops_.push_back(std::move(stop));
    if (next > 0) {
      go_to(next, newest_);
    }
    newest_ = after_answer(next);
  }
  if (stops_.size() > before) {
    map_prediction_ =
        predict_in_map(newest_, frames_[stops_.size() - 1].odometry, frames_.last_imu()->stamp);
  }
}

void CoupledFusion::go_to(std::size_t frame, const MapBodyFilter& previous) {
  Stop& stop = stops_[frame];
  if (!stop.from_previous) {  // what the filter knew ends with the IMU
    stop.filter = MapBodyFilter(config_.answers);
    return;
  }
  stop.filter = previous;
  stop.filter.propagate(*stop.from_previous, frames_[frame].drift);
  stop.filter.correct(frames_[frame].odometry.state.T_odom_body);
}

PoseFusion::Verdict CoupledFusion::add_answer(const LocalizationResult& answer) {
  if (const std::string_view reason = frames_.why_unusable(answer); !reason.empty()) {
    return {.applied = false, .reason = reason};
  }
  if (stops_.empty() || answer.stamp > frames_[stops_.size() - 1].odometry.stamp) {
    return {.applied = false, .reason = "unknown_stamp"};
  }
  const auto taken = frames_.add_answer(answer);
  if (const auto* reason = std::get_if<std::string_view>(&taken)) {
    return {.applied = false, .reason = *reason};
  }
  const std::size_t frame = std::get<std::size_t>(taken);
  const int revised = replay_from(frame);
  const LocalizationOutcome outcome = *frames_[frame].answer->outcome;
  return {.applied = is_applied(outcome), .reason = name(outcome), .revised = revised};
}

int CoupledFusion::replay_from(std::size_t frame) {
  int revised = 0;
  for (std::size_t i = frame; i < stops_.size(); ++i) {
    if (i > frame) {
      go_to(i, newest_);
    }
    newest_ = stops_[i].filter;
    if (auto& stored = frames_[i].answer) {
      const LocalizationOutcome outcome = newest_.apply(stored->measurement, frames_[i].odometry);
      const std::optional<LocalizationOutcome> before = std::exchange(stored->outcome, outcome);
      revised += before && is_applied(*before) != is_applied(outcome) ? 1 : 0;
    }
  }
  map_prediction_ =
      predict_in_map(newest_, frames_[stops_.size() - 1].odometry, frames_.last_imu()->stamp);
  return revised;
}

MapBodyFilter CoupledFusion::after_answer(std::size_t frame) const {
  MapBodyFilter filter = stops_[frame].filter;
  if (const auto& stored = frames_[frame].answer) {
    filter.apply(stored->measurement, frames_[frame].odometry);
  }
  return filter;
}

std::optional<ImuPrediction> CoupledFusion::predict_in_map(const MapBodyFilter& filter,
                                                           const OdometryEstimate& from,
                                                           Timestamp to) const {
  const std::vector<ImuSample> samples = frames_.imu().between(from.stamp, to);
  if (!filter.last_applied() || samples.empty()) {
    return std::nullopt;
  }
  return predict({from.stamp, filter.state(), filter.covariance()}, samples, frames_.noise());
}

std::optional<PoseEstimate> CoupledFusion::estimate_at(Timestamp stamp) const {
  const std::optional<std::size_t> index = frames_.index_at(stamp);
  if (!index || *index >= stops_.size()) {
    return std::nullopt;
  }
  const OdometryEstimate& start = frames_[*index].odometry;
  const std::vector<ImuSample> samples = frames_.imu().between(start.stamp, stamp);
  if (samples.empty()) {
    return std::nullopt;
  }
  const MapBodyFilter filter = after_answer(*index);
  return estimate(
      predict(start, samples, frames_.noise()), predict_in_map(filter, start, stamp), filter);
}

PoseEstimate CoupledFusion::estimate(const ImuPrediction& in_odom,
                                     const std::optional<ImuPrediction>& in_map,
                                     const MapBodyFilter& filter) const {
  PoseEstimate result = odom_estimate(in_odom);
  if (in_map) {
    assert(in_map->stamp == in_odom.stamp);
    result.T_map_body = in_map->state.T_odom_body;
    result.covariance_map = pose_covariance(*in_map);
  }
  judge(result,
        {.last_applied = filter.last_applied(),
         .contradicted = filter.contradicted(),
         .carried = interrupted_,
         .newest_odometry = frames_.newest().odometry.stamp},
        config_);
  return result;
}

std::optional<MapOdomEstimate> CoupledFusion::start_pose() const {
  return newest_.start_pose();
}

}  // namespace fleetloc
