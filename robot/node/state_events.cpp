#include "robot/node/state_events.hpp"

#include <chrono>

namespace fleetloc {
namespace {

constexpr std::chrono::seconds kLasting{1};
constexpr std::chrono::seconds kBetweenReasons{10};  // which may change with each answer

}  // namespace

std::vector<std::string> StateEvents::add(const RobotOutput& output) {
  std::vector<std::string> events;
  for (const LocalizationOutput& answer : output.answers) {
    if (auto event = reason_in(answer)) events.push_back(std::move(*event));
  }
  for (const FrameOutput& frame : output.frames) {
    if (auto event = state_with(frame)) events.push_back(std::move(*event));
  }
  return events;
}

std::optional<std::string> StateEvents::state_with(const FrameOutput& frame) {
  const Quality state = frame.pose.quality;
  const bool is_clock_behind = frame.pose.stamp < since_;
  if (state != latest_ || is_clock_behind) since_ = frame.pose.stamp;
  latest_ = state;
  if (state == told_ || frame.pose.stamp - since_ < kLasting) return std::nullopt;
  told_ = state;
  return "state: " + std::string(name(state));
}

std::optional<std::string> StateEvents::reason_in(const LocalizationOutput& answer) {
  const LocalizationStatus status = answer.answer.status;
  if (status == LocalizationStatus::kLocalized) {
    reason_.reset();
    return std::nullopt;
  }
  const bool is_clock_behind = answer.arrival < reason_told_;
  const bool is_soon =
      reason_ && !is_clock_behind && answer.arrival - reason_told_ < kBetweenReasons;
  if (told_ == Quality::kLocalized || status == reason_ || is_soon) return std::nullopt;
  reason_ = status;
  reason_told_ = answer.arrival;
  const int places = answer.answer.places;
  return "not localized: " + std::string(name(status)) +
         (places > 0 ? " (places: " + std::to_string(places) + ")" : "") + ", says " +
         answer.answer.localizer;
}

}  // namespace fleetloc
