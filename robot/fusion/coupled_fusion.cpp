#include "robot/fusion/coupled_fusion.hpp"

#include <cassert>
#include <utility>

namespace fleetloc {

CoupledFusion::CoupledFusion(const ImuNoise& noise, const Config& config)
    : config_(config), frames_(noise, config), newest_(config.answers) {}

// The filter is tied to the old odom frame: the next answer initializes it again.
void CoupledFusion::reset(SessionNumber session,
                          const std::optional<MapOdomEstimate>& /*carried*/) {
  frames_.reset(session);
  interrupted_ = false;
  filter_states_.clear();
  newest_ = MapBodyFilter(config_.answers);
  map_prediction_.reset();
}

void CoupledFusion::forget_map(SessionNumber session) {
  frames_.forget_answers(session);
  newest_ = MapBodyFilter(config_.answers);
  for (FilterState& state : filter_states_) state.filter = newest_;
  map_prediction_.reset();
}

PoseEstimate CoupledFusion::add_imu(const ImuSample& sample) {
  if (frames_.add_imu(sample)) {
    if (map_prediction_) {
      advance(*map_prediction_, *frames_.previous_imu(), sample, frames_.noise());
    }
    propagate_to_new_frames();
  }
  if (frames_.prediction() && !filter_states_.empty()) {
    return estimate(*frames_.prediction(), map_prediction_, newest_);
  }
  PoseEstimate nothing;
  nothing.stamp = frames_.last_imu() ? frames_.last_imu()->stamp : sample.stamp;
  return nothing;
}

expected<void, FusionRejection> CoupledFusion::add_odometry(const OdometryEstimate& estimate) {
  if (const auto added = frames_.add_odometry(estimate); !added) return added;
  propagate_to_new_frames();
  while (frames_.has_stale() && filter_states_.size() > 1) {
    frames_.forget_oldest();
    filter_states_.pop_front();
  }
  return {};
}

// Preintegrated about the odometry's biases, so that the result does not depend on the order of
// arrival.
void CoupledFusion::propagate_to_new_frames() {
  const std::size_t before = filter_states_.size();
  while (filter_states_.size() < frames_.size()) {
    const std::size_t next = filter_states_.size();
    const OdometryEstimate& frame = frames_[next].odometry;
    if (!frames_.last_imu() || frame.stamp > frames_.last_imu()->stamp) {
      break;
    }
    FilterState state{.from_previous = std::nullopt, .filter = MapBodyFilter(config_.answers)};
    if (next > 0) {
      const OdometryEstimate& previous = frames_[next - 1].odometry;
      const std::vector<ImuSample> samples = frames_.imu().between(previous.stamp, frame.stamp);
      if (samples.size() > 1) {
        state.from_previous.emplace(samples, previous.state.bias, frames_.noise());
      }
    }
    filter_states_.push_back(std::move(state));
    if (next > 0) {
      propagate_to(next, newest_);
    }
    newest_ = after_answer(next);
  }
  if (filter_states_.size() > before) {
    map_prediction_ = predict_in_map(
        newest_, frames_[filter_states_.size() - 1].odometry, frames_.last_imu()->stamp);
  }
}

void CoupledFusion::propagate_to(std::size_t frame, const MapBodyFilter& previous) {
  FilterState& state = filter_states_[frame];
  if (!state.from_previous) {  // IMU gap: the next answer initializes the filter again
    state.filter = MapBodyFilter(config_.answers);
    return;
  }
  state.filter = previous;
  state.filter.propagate(*state.from_previous, frames_[frame].drift);
  state.filter.correct(frames_[frame].odometry.state.T_odom_body);
}

void CoupledFusion::lose() {
  if (frames_.empty()) return;
  frames_.lose();
  if (filter_states_.size() == frames_.size()) replay_from(filter_states_.size() - 1);
}

AnswerOutcome CoupledFusion::add_answer(const LocalizationResult& answer) {
  if (answer.status == LocalizationStatus::kLost) {
    const auto lost = frames_.add_loss(answer);
    if (lost && *lost < filter_states_.size()) replay_from(*lost);
  }
  if (const auto usable = frames_.check(answer); !usable) return unexpected(usable.error());
  if (filter_states_.empty() || answer.stamp > frames_[filter_states_.size() - 1].odometry.stamp) {
    return unexpected(FusionRejection::kUnknownStamp);
  }
  const auto frame = frames_.add_answer(answer);
  if (!frame) return unexpected(frame.error());
  replay_from(*frame);
  return *frames_[*frame].answer->outcome;
}

void CoupledFusion::replay_from(std::size_t frame) {
  for (std::size_t i = frame; i < filter_states_.size(); ++i) {
    if (i > frame) {
      propagate_to(i, newest_);
    }
    newest_ = filter_states_[i].filter;
    if (frames_[i].is_lost) newest_.lose();
    if (auto& stored = frames_[i].answer) {
      stored->outcome = newest_.apply(stored->measurement, frames_[i].odometry);
    }
  }
  map_prediction_ = predict_in_map(
      newest_, frames_[filter_states_.size() - 1].odometry, frames_.last_imu()->stamp);
}

MapBodyFilter CoupledFusion::after_answer(std::size_t frame) const {
  MapBodyFilter filter = filter_states_[frame].filter;
  if (frames_[frame].is_lost) filter.lose();
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
  if (!index || *index >= filter_states_.size()) {
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
  set_pose_quality(result,
                   {.last_applied = filter.last_applied(),
                    .contradicted = filter.contradicted(),
                    .carried = interrupted_,
                    .newest_odometry = frames_.newest().odometry.stamp},
                   config_);
  return result;
}

std::optional<MapOdomEstimate> CoupledFusion::session_start() const {
  return newest_.session_start();
}

}  // namespace fleetloc
