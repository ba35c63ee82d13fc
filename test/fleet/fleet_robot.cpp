// Robots of a fleet, without cameras: the real client of the cloud on a real participant for each.
// They open a session, tell their localizer of themselves, and measure what the network costs and
// how long a localizer takes to answer.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "deploy/config/default_config.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/program.hpp"
#include "shared/transport/dds_channel.hpp"

namespace {

using namespace fleetloc;
using Clock = std::chrono::steady_clock;
using std::chrono::duration;

struct Options {
  std::string id, qos, link, security;
  std::uint32_t domain = 0;
  int count = 1;
  double submaps_hz = 0.0;
  double start_s = 12.0;
  double settled_s = 60.0;
  double rest_s = 30.0;
};

RobotSession session_of(const std::string& robot) {
  RobotSession session;
  session.robot = robot;
  session.session = SessionNumber{1};
  session.start_stamp = Timestamp{std::chrono::system_clock::now().time_since_epoch()};
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

Timestamp steady_now() {
  return Timestamp{Clock::now().time_since_epoch()};
}

std::optional<LinkConfig> link_in(const std::string& file) {
  if (file.empty()) return std::nullopt;
  return read_link_config(ConfigReader::from_file(file));
}

std::optional<FleetKeys> keys_in(const Options& options) {
  if (options.security.empty()) return std::nullopt;
  return FleetKeys(std::filesystem::path(options.security) / options.id);
}

class FleetRobot {
 public:
  FleetRobot(const Options& options, const CloudClient::Config& config)
      : options_(options),
        channel_({.domain = options.domain,
                  .participant_profile = "robot",
                  .role = ChannelRole::kRobot,
                  .name = options.id,
                  .link = link_in(options.link),
                  .keys = keys_in(options)}),
        client_(options.id, channel_, config) {}

  /// Prints a line: id, bytes up and down in the first `start_s`, bytes per second up and down at
  /// rest, and when a localizer was found [s], negative if never. Before it, for each localizer
  /// that was chosen: "chosen", id, localizer, age [s], and how long it took to answer [s].
  void run(const std::stop_token& stop) {
    client_.start_session(session_of(options_.id), steady_now());
    const ChannelStatistics start = after(options_.start_s, stop);
    const ChannelStatistics settled = after(options_.settled_s, stop);
    const ChannelStatistics end = after(options_.settled_s + options_.rest_s, stop);
    std::printf(
        "%s %.0f %.0f %.1f %.1f %.2f\n",
        options_.id.c_str(),
        static_cast<double>(start.sent_wire_bytes),
        static_cast<double>(start.received_wire_bytes),
        static_cast<double>(end.sent_wire_bytes - settled.sent_wire_bytes) / options_.rest_s,
        static_cast<double>(end.received_wire_bytes - settled.received_wire_bytes) /
            options_.rest_s,
        found_s_);
  }

 private:
  [[nodiscard]] double age() const { return duration<double>(Clock::now() - begin_).count(); }

  // Lives on until then.
  ChannelStatistics after(double age_s, const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kCycle{50};
    while (age() < age_s && !stop.stop_requested()) {
      channel_.wait_for_message(kCycle);
      if (!client_.take_answers(steady_now()).empty()) note_answer();
      static_cast<void>(client_.take_events());
      note_choice();
      if (options_.submaps_hz > 0.0 && age() * options_.submaps_hz > submaps_) submit();
    }
    return channel_.statistics();
  }

  // Without anything to localize: its answer says so.
  void submit() {
    Submap submap;
    submap.keyframes.push_back({.id = KeyframeId{++submaps_},
                                .revision = Revision{1},
                                .stamp = steady_now(),
                                .T_odom_body = {},
                                .tilt_sigma = 0.01,
                                .observations = {}});
    client_.submit(std::move(submap), steady_now());
  }

  void note_choice() {
    const std::string localizer = client_.statistics().localizer;
    if (localizer == localizer_) return;
    localizer_ = localizer;
    chosen_s_ = age();
    is_answered_ = false;
    if (found_s_ < 0.0) found_s_ = age();
  }

  void note_answer() {
    if (std::exchange(is_answered_, true)) return;
    std::printf("chosen %s %s %.2f %.2f\n",
                options_.id.c_str(),
                localizer_.c_str(),
                chosen_s_,
                age() - chosen_s_);
    std::fflush(stdout);
  }

  Options options_;
  Clock::time_point begin_ = Clock::now();
  double found_s_ = -1.0;
  std::string localizer_;
  double chosen_s_ = 0.0;
  bool is_answered_ = false;
  std::uint32_t submaps_ = 0;
  DdsChannel channel_;
  CloudClient client_;
};

}  // namespace

int main(int argc, char** argv) {
  return guarded([&] {
    Program program(
        "fleet_robot", "Robots of a fleet, without cameras.", default_config("everything"));
    Options options;
    CLI::App& app = program.options();
    app.add_option("--robot-id", options.id, "1 to 32 of A-Z a-z 0-9 _ -")->required();
    app.add_option("--qos", options.qos, "QoS profiles")->required();
    app.add_option("--count", options.count, "robots in this process, ID_1 and so on");
    app.add_option("--domain", options.domain, "DDS domain, 0 to 100");
    app.add_option("--link", options.link, "YAML: loss, delay and rate to emulate");
    app.add_option("--security", options.security, "folder with a folder of keys for each robot");
    app.add_option("--submaps", options.submaps_hz, "submaps a second");
    app.add_option("--start", options.start_s, "seconds that count as the start");
    app.add_option("--settled", options.settled_s, "age from which on it is at rest [s]");
    app.add_option("--rest", options.rest_s, "seconds at rest");
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>();  // before any thread
      load_qos_profiles(options.qos);
      const auto config = read_cloud_client_config(program.config().section("client"));
      return [options, config, termination] {
        std::vector<std::jthread> robots;
        for (int i = 1; i <= options.count; ++i) {
          Options one = options;
          if (options.count > 1) one.id += "_" + std::to_string(i);
          robots.emplace_back(
              [one, config, token = termination->token()] { FleetRobot(one, config).run(token); });
        }
        robots.clear();  // waits for their ends
        return static_cast<int>(kSuccess);
      };
    });
  });
}
