#include "robot/runtime/robot_runtime.hpp"

#include <utility>
#include <variant>

namespace fleetloc {

RobotRuntime::RobotRuntime(const std::string& name,
                           SensorSource& sensors,
                           RobotPipeline& robot,
                           const MapLocalizer* localizer,
                           std::vector<std::reference_wrapper<RobotSink>> sinks)
    : sensors_(sensors),
      robot_(robot),
      localizer_(localizer),
      sinks_(std::move(sinks)),
      progress_(std::in_place, name) {}

void RobotRuntime::run(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const auto finish_run = [&] {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    finish(wall.count(), stop.stop_requested());
  };
  try {
    while (auto measurement = sensors_.next(stop)) take(std::move(*measurement));
  } catch (...) {
    finish_run();
    throw;
  }
  finish_run();
}

void RobotRuntime::take(SensorMeasurement measurement) {
  if (auto* frame = std::get_if<CameraFrame>(&measurement)) {
    add(std::move(*frame));
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
                           .traffic = traffic()};
  for (RobotSink& sink : sinks_) sink.add(output);
}

void RobotRuntime::finish(double wall_s, bool interrupted) {
  auto faults = sensors_.close();
  progress_.reset();
  deliver(std::nullopt);
  for (const RobotSink& sink : sinks_) {
    for (const auto& [kind, count] : sink.faults()) faults[kind] += count;
  }
  const RunEnd end{.robot = robot_,
                   .traffic = traffic(),
                   .interrupted = interrupted,
                   .wall_s = wall_s,
                   .decode_ms = decode_ms_,
                   .faults = std::move(faults)};
  for (RobotSink& sink : sinks_) sink.finish(end);
}

LinkTraffic RobotRuntime::traffic() const {
  return localizer_ != nullptr ? localizer_->traffic() : LinkTraffic{};
}

}  // namespace fleetloc
