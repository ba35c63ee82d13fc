#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/laser_map/map_regions.hpp"
#include "cloud/localizer/session_localizer.hpp"
#include "cloud/locate/pyramid_config.hpp"
#include "cloud/pool/early_samples.hpp"
#include "cloud/pool/fair_scheduler.hpp"
#include "cloud/pool/pool_report.hpp"
#include "cloud/pool/served_robots.hpp"
#include "cloud/pool/session_protocol.hpp"
#include "cloud/pool/waiting_submaps.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/link/channel.hpp"
#include "shared/protocol/sender_binding.hpp"

namespace fleetloc {

class ConfigReader;

/// Localizes many robots: takes messages, hands out the localizations that are due, and gives the
/// messages to send. SessionProtocol decides what is accepted, FairScheduler whose turn it is, and
/// PoolReport counts. The pool owns no thread and reads no clock: jobs may run on any thread, one
/// at a time for each robot; everything else is one thread's. The memory of a robot is bounded, and
/// freed when it has been silent for long.
class LocalizerPool {
 public:
  struct Config {
    SessionLocalizer::Config localizer;
    PyramidConfig pyramid;
    SessionProtocol::Config protocol;
    WaitingSubmaps::Limits waiting;  ///< of one robot
    double max_waiting_s;            ///< since a robot's newest submap; then its work is dropped
    std::size_t max_session_bytes;   ///< of one robot's localizer; beyond, its session is ended
  };

  /// One localization: everything that has arrived of one robot since its last one. Nothing may
  /// have: a search for its first place goes on in turns, and takes those that nobody else needs.
  struct Job {
    RobotId robot;
    std::uint64_t turn = 0;  ///< of the robot
    Timestamp received;      ///< the oldest of the submaps, if there are any
    Timestamp started;
    std::shared_ptr<SessionLocalizer> session;
    /// Of the same session with another start: what it has stored goes over to `session`.
    std::shared_ptr<const SessionLocalizer> predecessor;
    std::vector<Submap> submaps;
    Duration round_trip;                   ///< of the network to the robot; 0: not known
    std::optional<Correction> correction;  ///< what run() found beside the answer
    std::string error;                     ///< why run() failed; empty: it did not
  };

  /// @param pyramid  of the map; null: robots without a start pose are never localized
  /// @param regions  of the map, in which robots may say that they are
  LocalizerPool(std::string name,
                Incarnation incarnation,
                std::shared_ptr<const LaserMap> map,
                const Config& config,
                std::shared_ptr<const MapPyramid> pyramid = nullptr,
                MapRegions regions = {});

  void receive(const Message& message, Timestamp now);

  /// A job of the robot that has used the least worker time, of those that wait and have none
  /// running.
  std::optional<Job> take_job(Timestamp now);

  /// Stores the submaps of a job; the first part of run().
  static void take_over(Job& job);

  /// Does the work of a job. Static, since it may run beside everything else.
  static LocalizationResult run(Job& job);

  /// Takes the result over. `optimize_ms` is only reported.
  void finish(const Job& job, LocalizationResult answer, double optimize_ms, Timestamp now);

  /// New answers, repetitions, and from time to time the localizer's own status.
  std::vector<OutgoingMessage> outgoing(Timestamp now, double load);

  /// The localizer is about to end: its robots are told to go to others, and answered meanwhile.
  void drain(Timestamp now) { protocol_.drain(now); }
  /// Robots that it still has to answer; none once its time is over.
  [[nodiscard]] std::vector<RobotId> to_leave(Timestamp now) const {
    return protocol_.to_leave(now);
  }

  /// Robots that are served or may come, new since the last call: Channel::prepare.
  std::vector<RobotId> take_expected() { return protocol_.take_expected(); }
  /// Events since the last call, each a line for the log.
  std::vector<std::string> take_events() { return report_.take_events(); }

  /// Of the robots that are served, and of the latest that were.
  [[nodiscard]] std::map<RobotId, SessionReport> reports() const { return report_.reports(); }
  /// Messages of robots that are not served, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& unattributed() const {
    return report_.unattributed();
  }
  /// The robots that are served, for those who watch the fleet.
  [[nodiscard]] std::vector<ServedRobot> served(Timestamp now) const { return served_.all(now); }
  [[nodiscard]] std::size_t sessions() const { return protocol_.sessions(); }
  /// As of the last outgoing().
  [[nodiscard]] const LocalizerStatus& status() const { return protocol_.localizer_status(); }

 private:
  struct Robot {
    std::shared_ptr<SessionLocalizer> localizer;
    std::shared_ptr<const SessionLocalizer> predecessor;  // see Job
    WaitingSubmaps waiting;
  };

  bool is_of_its_writer(const RobotId& robot, const MessageSender& sender, Timestamp now);
  void receive_session(const RobotSession& session, Timestamp now);
  void receive_submap(Submap submap, std::size_t bytes, Timestamp now);
  void receive_submap(const SubmapSample& sample, std::size_t bytes, Timestamp now);
  void add_submap(Submap submap, std::size_t bytes, Timestamp now);
  void receive_status(const RobotStatus& status, std::size_t bytes, Timestamp now);
  void open(const RobotSession& session, SessionProtocol::Change change, Timestamp now);
  void end(const RobotId& robot, const std::string& why);
  [[nodiscard]] std::optional<MapRegion> region_of(const RobotSession& session);
  void clean_up(Timestamp now);

  std::shared_ptr<const LaserMap> map_;
  std::shared_ptr<const MapPyramid> pyramid_;
  MapRegions regions_;
  Config config_;
  SenderBinding writers_;
  SessionProtocol protocol_;
  FairScheduler scheduler_;
  PoolReport report_;
  ServedRobots served_;
  EarlySamples early_;
  std::map<RobotId, Robot> robots_;  // that have a session here
  std::optional<Timestamp> cleaned_up_;
};

LocalizerPool::Config read_localizer_pool_config(ConfigReader config);

}  // namespace fleetloc
