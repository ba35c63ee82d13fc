#include "robot/runtime/robot_runtime.hpp"

#include <utility>
#include <variant>

namespace fleetloc {

RobotRuntime::RobotRuntime(const std::string& name,
                           SensorSource& sensors,
                           RobotPipeline& robot,
                           std::vector<std::reference_wrapper<RobotSink>> sinks)
    : sensors_(sensors), robot_(robot), sinks_(std::move(sinks)), progress_(std::in_place, name) {}

void RobotRuntime::run(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  std::exception_ptr failure;
  try {
    while (auto measurement = sensors_.next(stop)) take(std::move(*measurement));
  } catch (...) {
    failure = std::current_exception();
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  finish(wall.count(), stop.stop_requested() || failure != nullptr, failure);
}

void RobotRuntime::take(SensorMeasurement measurement) {
  if (auto* frame = std::get_if<CameraFrame>(&measurement)) {
    add(std::move(*frame));
  } else if (const auto* given = std::get_if<GivenPose>(&measurement)) {
    robot_.place(*given);
  } else if (const auto* step = std::get_if<ClockStep>(&measurement)) {
    robot_.step_clock(*step);
  } else {
    add(std::get<ImuSample>(measurement));
  }
}

void RobotRuntime::add(CameraFrame frame) {
  if (const auto* images = std::get_if<StereoFrame>(&frame)) {
    decode_ms_.add(1e3 * to_seconds(images->decoding_cpu));
  }
  robot_.add_frame(std::move(frame));
  ++frames_;
  if (const auto total = sensors_.frame_count()) progress_->show(frames_, *total);
}

// A sample that is rejected tells nothing, not even the time.
void RobotRuntime::add(const ImuSample& sample) {
  const auto pose = robot_.add_imu(sample);
  if (!pose) return;
  robot_.poll(pose->stamp);
  deliver(*pose);
}

void RobotRuntime::deliver(const std::optional<PoseEstimate>& pose) {
  const RobotOutput output{.pose = pose,
                           .frames = robot_.take_frames(),
                           .answers = robot_.take_answers(),
                           .traffic = robot_.traffic()};
  for (RobotSink& sink : sinks_) sink.add(output);
}

// What one of them throws does not keep the others from ending.
void RobotRuntime::finish(double wall_s, bool interrupted, std::exception_ptr failure) {
  const auto attempt = [&failure](const auto& action) {
    try {
      action();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  auto faults = sensors_.close();
  progress_.reset();
  attempt([&] { deliver(std::nullopt); });
  for (const RobotSink& sink : sinks_) {
    for (const auto& [kind, count] : sink.faults()) faults[kind] += count;
  }
  const RunEnd end{.robot = robot_,
                   .traffic = robot_.traffic(),
                   .interrupted = interrupted,
                   .wall_s = wall_s,
                   .decode_ms = decode_ms_,
                   .faults = std::move(faults)};
  for (RobotSink& sink : sinks_) attempt([&] { sink.finish(end); });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace fleetloc
