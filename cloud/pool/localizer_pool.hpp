#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/session_localizer.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/session.hpp"
#include "shared/protocol/repetition.hpp"
#include "shared/protocol/submap_receiver.hpp"

namespace fleetloc {

class ConfigReader;

/// What one robot has had of this localizer; written to sessions.json.
struct SessionReport {
  std::uint64_t submaps = 0;
  std::uint64_t localized = 0;
  std::map<std::string, std::uint64_t> rejected;  ///< localizations, by reason
  std::map<std::string, std::uint64_t> refused;   ///< messages, by reason
  std::vector<double> optimize_ms;                ///< of each localization
  std::vector<double> matches;                    ///< with the map, of each localization
  std::size_t memory_bytes = 0;
};

/// The localizer's end of the protocol, for many robots: validates what arrives, keeps a session
/// per robot, hands out the localizations that are due, and says what to send. It owns no thread
/// and reads no clock: jobs may run on any thread, one at a time for each robot; everything else
/// is one thread's.
class LocalizerPool {
 public:
  struct Config {
    SessionLocalizer::Config localizer;
    std::size_t max_sessions;
    std::size_t max_waiting_submaps;
    double status_interval_s;
    Repetition::Config repetition;
  };

  /// One localization: everything that has arrived of one robot since its last one.
  struct Job {
    RobotId robot;
    Timestamp received;  ///< the oldest of the submaps
    std::shared_ptr<SessionLocalizer> session;
    std::vector<Submap> submaps;
    std::optional<Correction> correction;  ///< what run() found beside the answer
    std::string error;                     ///< what run() could not do
  };

  struct Outgoing {
    std::string partition;
    Message message;
  };

  LocalizerPool(std::string name,
                Epoch epoch,
                std::shared_ptr<const LaserMap> map,
                const Config& config);

  void receive(const Message& message, Timestamp now);

  /// The next robot that waits and is not being worked on, in turn.
  std::optional<Job> take_job();

  /// Does the work of a job. Static, since it may run beside everything else.
  static Answer run(Job& job);

  /// Takes the result over. `optimize_ms` is only reported.
  void finish(const Job& job, Answer answer, double optimize_ms, Timestamp now);

  /// New answers with their corrections, repetitions of answers, and from time to time the
  /// localizer's own status.
  std::vector<Outgoing> outgoing(Timestamp now, double load);

  [[nodiscard]] std::map<RobotId, SessionReport> reports() const;
  /// Messages that belong to no session, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& unattributed() const {
    return unattributed_;
  }
  [[nodiscard]] std::size_t sessions() const { return robots_.size(); }

 private:
  struct Waiting {
    Submap submap;
    Timestamp received;
  };
  struct Robot {
    explicit Robot(const Repetition::Config& config) : repetition(config) {}

    std::optional<RobotSession> session;
    std::shared_ptr<SessionLocalizer> localizer;
    SubmapReceiver receiver;
    std::deque<Waiting> waiting;
    bool busy = false;
    std::optional<Answer> answer;  // the latest, with the acknowledgements when it was made
    bool unsent = false;
    std::optional<Correction> correction;  // of that answer, until it is sent
    Repetition repetition;
    SessionReport report;
  };

  void receive_session(const Bytes& payload);
  void receive_submap(const Bytes& payload, Timestamp now);
  void refuse(const RobotId& robot, std::string_view reason);
  void send_correction(const RobotId& id, Robot& robot, std::vector<Outgoing>& messages);
  [[nodiscard]] LocalizerStatus status(double load) const;

  std::string name_;
  Epoch epoch_;
  std::shared_ptr<const LaserMap> map_;
  Config config_;
  std::map<RobotId, Robot> robots_;
  RobotId last_served_;
  std::map<std::string, std::uint64_t> unattributed_;
  std::optional<Timestamp> status_sent_;
};

LocalizerPool::Config read_localizer_pool_config(ConfigReader config);

}  // namespace fleetloc
