#include "robot/node/last_pose.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose_text.hpp"

namespace fleetloc {
namespace {

constexpr std::chrono::seconds kInterval(2);
constexpr double kMoved_m = 0.05;
constexpr double kTurned_rad = 0.02;

bool has_moved(const Pose& from, const Pose& to) {
  return (to.p - from.p).norm() > kMoved_m || from.R.angularDistance(to.R) > kTurned_rad;
}

[[noreturn]] void fail(const std::filesystem::path& file) {
  throw std::runtime_error(file.string() + ": " + std::strerror(errno));
}

// On the disk before it gets its name, so that there is an old or a new pose, whatever fails.
void replace(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::path written = file;
  written += ".new";
  const int descriptor = open(written.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) fail(written);
  const bool complete =
      write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      fsync(descriptor) == 0;
  close(descriptor);
  if (!complete) fail(written);
  std::filesystem::rename(written, file);
}

}  // namespace

std::optional<Pose> read_last_pose(const std::filesystem::path& file, const RobotId& robot) {
  if (!std::filesystem::exists(file)) {
    spdlog::info("{}: no last pose in {} yet", robot, file.string());
    return std::nullopt;
  }
  try {
    ConfigReader reader = ConfigReader::from_file(file);
    const auto its = reader.get<std::string>("robot");
    if (its != robot) reader.fail("robot", "the last pose of another robot, " + its);
    return pose_from_text(reader.get<std::string>("T_map_body"));
  } catch (const std::exception& error) {
    spdlog::warn("{}: starts without a last pose: {}", robot, error.what());
    return std::nullopt;
  }
}

LastPoseFile::LastPoseFile(std::filesystem::path file, RobotId robot)
    : file_(std::move(file)),
      robot_(std::move(robot)),
      thread_([this](const std::stop_token& stop) { write_poses(stop); }) {}

LastPoseFile::~LastPoseFile() = default;

void LastPoseFile::add(const RobotOutput& output) {
  if (!output.pose || output.pose->quality != Quality::kLocalized) return;
  const Pose& T_map_body = *output.pose->T_map_body;
  if (given_ && !has_moved(*given_, T_map_body)) return;
  given_ = T_map_body;
  const std::lock_guard lock(mutex_);
  newest_ = T_map_body;
  is_new_.notify_one();
}

// The last one is written in any case.
void LastPoseFile::write_poses(const std::stop_token& stop) {
  bool is_failing = false;
  while (true) {
    std::unique_lock lock(mutex_);
    is_new_.wait(lock, stop, [this] { return newest_.has_value(); });
    const auto pose = std::exchange(newest_, std::nullopt);
    if (!pose) return;
    lock.unlock();
    try {
      replace(file_, "robot: " + robot_ + "\nT_map_body: " + pose_text(*pose) + "\n");
      is_failing = false;
    } catch (const std::exception& error) {
      if (!std::exchange(is_failing, true)) spdlog::warn("{}: {}", robot_, error.what());
    }
    lock.lock();
    is_new_.wait_for(lock, stop, kInterval, [] { return false; });
  }
}

}  // namespace fleetloc
