#include "test/fleet/driving_fleet.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProfiles = FLEETLOC_SOURCE_DIR "/qos_profiles/lan-server.xml";
constexpr double kNever = std::numeric_limits<double>::infinity();

std::string damage_of_table(const fs::path& file) {
  std::ifstream stream(file);
  const char separator = file.extension() == ".csv" ? ',' : ' ';
  std::optional<std::ptrdiff_t> fields;
  for (std::string line; std::getline(stream, line);) {
    if (stream.eof()) return file.string() + ": its last line has no end\n";
    const auto here = std::ranges::count(line, separator);
    if (fields && here != *fields) return file.string() + ": '" + line + "'\n";
    fields = here;
  }
  return {};
}

}  // namespace

DrivingFleet::DrivingFleet(const fs::path& folder, fs::path map, double drive_s)
    : folder_(folder), map_(std::move(map)), drive_s_(drive_s), containers_(folder) {}

void DrivingFleet::start_localizer(const std::string& name, const DockerFleet::Words& options) {
  start_localizer(name, map_, options);
}

void DrivingFleet::start_localizer(const std::string& name,
                                   const fs::path& map,
                                   const DockerFleet::Words& options) {
  containers_.start_in_cloud(
      name,
      {FLEETLOC_CLOUD, "--name", name, "--map", map, "--qos", kProfiles, "--out", folder_of(name)},
      options);
}

void DrivingFleet::wait_until_it_serves(const std::string& localizer) const {
  using std::chrono::steady_clock;
  const auto deadline = steady_clock::now() + std::chrono::minutes(1);
  const auto status = folder_of(localizer) / "status.csv";
  while (!fs::exists(status) || fs::file_size(status) == 0) {
    if (steady_clock::now() > deadline) throw std::runtime_error(localizer + " does not serve");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

void DrivingFleet::start_again(const std::string& localizer) const {
  fs::remove(folder_of(localizer) / "status.csv");  // of the one that was killed
  containers_.start_again(localizer);
}

void DrivingFleet::start_robot(const DrivingRobot& robot, const std::string& run) {
  containers_.start_at(robot.site,
                       run,
                       {FLEETLOC_ROBOT,
                        "--robot-id",
                        robot.id,
                        "--dataset",
                        robot.flight.folder,
                        "--tracks",
                        "--qos",
                        kProfiles,
                        "--start",
                        std::to_string(robot.start_s),
                        "--duration",
                        std::to_string(drive_s_),
                        "--initial-pose",
                        robot.flight.displaced_start_pose(robot.start_s),
                        "--out",
                        folder_of(run)});
}

std::string DrivingFleet::busiest(const std::vector<DrivingRobot>& robots) const {
  std::map<std::string, int> users;
  for (const DrivingRobot& robot : robots) {
    const auto answers = answers_of(folder_of(robot.id));
    if (!answers.empty()) ++users[answers.back().localizer];
  }
  if (users.empty()) throw std::runtime_error("no robot has had an answer");
  return std::ranges::max_element(users, {}, [](const auto& user) { return user.second; })->first;
}

Timestamp DrivingFleet::reached(const std::string& run) const {
  const auto frames = frames_of(folder_of(run));
  return frames.empty() ? Timestamp{} : frames.back().stamp;
}

double until_answer(const fs::path& run, Timestamp since) {
  const auto answers = answers_of(run);
  const auto next = std::ranges::find_if(answers, [since](const AnswerLine& answer) {
    return answer.applied && answer.arrival > since;
  });
  return next == answers.end() ? kNever : to_seconds(next->arrival - since);
}

double until_localized(const fs::path& run, Timestamp since) {
  const auto frames = frames_of(run);
  const auto next = std::ranges::find_if(frames, [since](const FrameLine& frame) {
    return frame.stamp >= since && frame.state == "localized";
  });
  return next == frames.end() ? kNever : to_seconds(next->stamp - since);
}

double longest_silence(const fs::path& run, Timestamp since) {
  double longest_s = 0.0;
  std::optional<Timestamp> last;
  for (const AnswerLine& answer : answers_of(run)) {
    if (!answer.applied) continue;
    if (last && answer.arrival > since) {
      longest_s = std::max(longest_s, to_seconds(answer.arrival - *last));
    }
    last = answer.arrival;
  }
  return longest_s;
}

std::string damage_of(const fs::path& folder) {
  std::string damage;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".csv" || extension == ".tum") damage += damage_of_table(entry.path());
    if (extension != ".json") continue;
    try {
      parsed_json(entry.path());
    } catch (const std::exception& error) {
      damage += entry.path().string() + ": " + error.what() + '\n';
    }
  }
  return damage;
}

}  // namespace fleetloc
