#include "robot/node/threaded_back_end.hpp"

namespace fleetloc {

ThreadedBackEnd::ThreadedBackEnd(KeyframeWorker worker)
    : worker_(std::move(worker)), thread_([this](const std::stop_token& stop) { work(stop); }) {}

void ThreadedBackEnd::work(const std::stop_token& stop) {
  while (auto job = jobs_.pop(stop)) {
    try {
      results_.push(worker_.run(*job), stop);
    } catch (...) {
      results_.push(std::current_exception(), stop);
    }
  }
}

void ThreadedBackEnd::start(KeyframeJob job, Timestamp /*now*/) {
  jobs_.push(std::move(job));
}

std::optional<KeyframeResult> ThreadedBackEnd::take(Timestamp /*now*/) {
  auto result = results_.try_pop();
  if (!result) return std::nullopt;
  if (auto* error = std::get_if<std::exception_ptr>(&*result)) std::rethrow_exception(*error);
  return std::get<KeyframeResult>(std::move(*result));
}

}  // namespace fleetloc
