#include "robot/node/threaded_back_end.hpp"

namespace fleetloc {

ThreadedBackEnd::ThreadedBackEnd(KeyframeWorker worker)
    : worker_(std::move(worker)), thread_([this](const std::stop_token& stop) {
        while (auto job = jobs_.pop(stop)) results_.push(worker_.run(*job), stop);
      }) {}

void ThreadedBackEnd::start(KeyframeJob job, Timestamp /*now*/) {
  jobs_.push(std::move(job));
}

std::optional<KeyframeResult> ThreadedBackEnd::take(Timestamp /*now*/) {
  return results_.try_pop();
}

}  // namespace fleetloc
