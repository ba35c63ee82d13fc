// fleetloc-topic: what is on the wire, decoded.
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>

#include "deploy/config/default_config.hpp"
#include "deploy/topic/sample_decoder.hpp"
#include "deploy/topic/sample_text.hpp"
#include "deploy/topic/topic_table.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/option_check.hpp"
#include "shared/config/program.hpp"
#include "shared/transport/qos_profiles.hpp"
#include "shared/transport/topic_observer.hpp"

namespace {

using namespace fleetloc;
using Clock = std::chrono::steady_clock;

constexpr const char* kDescription =
    "Shows what is on the wire between robots and localizers, decoded.\n\n"
    "It joins as one more reader of the topics that it shows. Best effort goes to each reader in a "
    "datagram of its own, so while it reads a robot's submaps that robot's uplink carries each of "
    "them twice, and each answer of a localizer is sent twice. `list --no-read` only looks at "
    "discovery. Poses (fleetloc/pose) are seen on the robot's own computer only.";

struct Arguments {
  std::string security;
  std::string qos;
  std::string profile = "robot";
  std::uint32_t domain = 0;
  double duration_s = 0.0;  // 0: without end
  std::size_t count = 0;    // 0: all
  std::string topic;
  bool is_json = false;
  bool reads = true;
};

/// lan.xml of the installation or the source tree that this program is in.
std::string default_qos() {
  const auto program = std::filesystem::read_symlink("/proc/self/exe");
  for (auto folder = program.parent_path(); folder != folder.root_path();
       folder = folder.parent_path()) {
    for (const char* place : {"qos_profiles", "share/fleetloc/tools/qos_profiles"}) {
      const auto file = folder / place / "lan.xml";
      if (std::filesystem::exists(file)) return file.string();
    }
  }
  throw std::invalid_argument("--qos: no qos_profiles/lan.xml near the program; name a file");
}

/// Waits a little. False when it is time to end.
class Pace {
 public:
  Pace(std::stop_token stop, double duration_s)
      : stop_(std::move(stop)),
        end_(duration_s > 0.0 ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(duration_s))
                              : Clock::time_point::max()) {}

  bool wait() {
    constexpr std::chrono::milliseconds kLook(20);
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop_, kLook, [] { return false; });
    return !stop_.stop_requested() && Clock::now() < end_;
  }

 private:
  std::stop_token stop_;
  Clock::time_point end_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
};

int list(TopicObserver& observer, const Arguments& arguments, const std::stop_token& stop) {
  std::map<std::string, HeardTraffic> heard;
  const auto begin = Clock::now();
  for (Pace pace(stop, arguments.duration_s); pace.wait();) {
    if (!arguments.reads) continue;
    for (const ObservedTopic& topic : observer.topics()) {
      if (observer.read(topic.name)) heard.try_emplace(topic.name);
    }
    for (const ObservedSample& sample : observer.take()) {
      ++heard[sample.topic].samples;
      heard[sample.topic].bytes += sample.payload.size();
    }
  }
  const std::chrono::duration<double> listened = Clock::now() - begin;
  std::cout << topic_table(
      observer.topics(), heard, arguments.reads ? std::optional(listened.count()) : std::nullopt);
  return kSuccess;
}

/// Joins what is meant, and the sessions without which submaps cannot be decoded.
void join(TopicObserver& observer, const std::string& wanted) {
  for (const ObservedTopic& topic : observer.topics()) {
    if (observer.reads(topic.name) || !is_meant(wanted, topic.name)) continue;
    observer.read(topic.name);
    const auto known = topic_of(topic.name);
    if (known && known->first == Topic::kCompactSubmap) {
      observer.read(topic_spec(Topic::kSession, known->second).name);
    }
  }
}

int echo(TopicObserver& observer, const Arguments& arguments, const std::stop_token& stop) {
  SampleDecoder decoder;
  std::size_t left =
      arguments.count > 0 ? arguments.count : std::numeric_limits<std::size_t>::max();
  for (Pace pace(stop, arguments.duration_s); left > 0 && pace.wait();) {
    join(observer, arguments.topic);
    for (const ObservedSample& sample : observer.take()) {
      SampleDecoder::Json fields = decoder.decode(sample.topic, sample.payload);
      if (left == 0 || !is_meant(arguments.topic, sample.topic)) continue;
      --left;
      SampleDecoder::Json shown{{"topic", sample.topic}, {"bytes", sample.payload.size()}};
      shown.update(fields);
      if (arguments.is_json) {
        std::cout << shown.dump() << '\n' << std::flush;
      } else {
        std::cout << "---\n" << sample_text(shown) << std::flush;
      }
    }
  }
  return kSuccess;
}

void add_common(CLI::App& command, Arguments& arguments) {
  command.add_option(
      "--qos", arguments.qos, "QoS profiles that the fleet uses; lan.xml if nothing is said");
  command.add_option("--profile", arguments.profile, "participant in that file: robot or cloud");
  command.add_option("--domain", arguments.domain, "DDS domain, 0 to 100");
  command.add_option("--security",
                     arguments.security,
                     "folder of an observer's keys, made by deploy/security/fleet-keys.sh");
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program("fleetloc-topic", kDescription, default_config("everything"));
    Arguments arguments;
    CLI::App& app = program.options();
    app.require_subcommand(1);
    CLI::App* list_command =
        app.add_subcommand("list", "Topics, types, writers, readers, rates")->fallthrough();
    add_common(*list_command, arguments);
    auto* listening =
        list_command
            ->add_option(
                "--duration", arguments.duration_s, "seconds to listen; 5 if nothing is said")
            ->check(positive_up_to(kLongest_s));
    list_command->add_flag("!--no-read", arguments.reads, "do not join: no rates, no traffic");
    CLI::App* echo_command = app.add_subcommand("echo", "Samples as they arrive")->fallthrough();
    add_common(*echo_command, arguments);
    echo_command->add_option(
        "topic", arguments.topic, "its name or the end of it, as in robot_1/localization; or all");
    echo_command->add_flag("--json", arguments.is_json, "a line of JSON for each");
    echo_command->add_option("--count", arguments.count, "end after so many samples")
        ->check(whole_number());
    echo_command->add_option("--duration", arguments.duration_s, "end after so many seconds")
        ->check(positive_up_to(kLongest_s));
    return program.run(argc, argv, [&]() -> Program::Run {
      auto termination = std::make_shared<Termination>();  // before any thread
      if (list_command->parsed() && listening->count() == 0) arguments.duration_s = 5.0;
      load_qos_profiles(arguments.qos.empty() ? default_qos() : arguments.qos);
      std::optional<FleetKeys> keys;
      if (!arguments.security.empty()) keys.emplace(arguments.security);
      auto observer =
          std::make_shared<TopicObserver>(arguments.domain, arguments.profile, "local", keys);
      const auto run = list_command->parsed() ? list : echo;
      return [=] { return run(*observer, arguments, termination->token()); };
    });
  });
}
