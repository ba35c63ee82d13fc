#pragma once

#include <utility>

#include <spdlog/spdlog.h>

#include "robot/run_folder/run_recorder.hpp"
#include "robot/runtime/robot_sink.hpp"
#include "shared/concurrency/reload_request.hpp"

namespace fleetloc {

/// Does what a reload asks for: a new part of the run folder.
class ReloadSink final : public RobotSink {
 public:
  /// @param recorder  may be null
  ReloadSink(RobotId robot, ReloadRequest& request, RunRecorder* recorder)
      : robot_(std::move(robot)), request_(request), recorder_(recorder) {}

  void add(const RobotOutput& /*output*/) override {
    if (!request_.take()) return;
    if (recorder_ == nullptr) {
      spdlog::info("{}: SIGHUP: there is no run folder to begin anew", robot_);
      return;
    }
    recorder_->begin_part();
    spdlog::info("{}: SIGHUP: a new part of the run folder", robot_);
  }

 private:
  RobotId robot_;
  ReloadRequest& request_;
  RunRecorder* recorder_;
};

}  // namespace fleetloc
