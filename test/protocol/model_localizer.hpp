#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "cloud/pool/localizer_pool.hpp"
#include "test/protocol/disturbed_network.hpp"
#include "test/protocol/sent_record.hpp"

namespace fleetloc {

/// A localizer with its real end of the protocol and its real databases; only the estimation is a
/// stand-in, which takes a random time and answers by chance. It checks its databases after each
/// job and its acknowledgements before each answer, and throws Violation.
class ModelLocalizer {
 public:
  ModelLocalizer(std::string name,
                 Incarnation incarnation,
                 std::shared_ptr<const LaserMap> map,
                 const LocalizerPool::Config& config,
                 DisturbedNetwork& network,
                 SentRecord& record,
                 std::uint32_t seed);

  void step(Timestamp now);

  /// Jobs take that long from now on, mean.
  void set_job_time(double seconds) { job_time_s_ = seconds; }
  /// It hears nothing and says nothing for a while, and then goes on.
  void pause_until(Timestamp time) { paused_until_ = time; }

  /// Null if there is none of this session.
  [[nodiscard]] const SessionDatabase* database(const SessionKey& session) const;
  [[nodiscard]] const LocalizerPool& pool() const { return pool_; }
  [[nodiscard]] Incarnation incarnation() const { return incarnation_; }

 private:
  struct Running {
    LocalizerPool::Job job;
    LocalizationResult answer;
  };
  /// What has become of the samples of one robot: `stored` are those in the database.
  struct Stream {
    SessionKey session;
    std::shared_ptr<SessionLocalizer> localizer;
    std::set<std::uint32_t> stored;
    std::set<std::uint32_t> lost;     // with the database before
    std::set<std::uint32_t> claimed;  // acknowledged, and not stored before the next job
  };

  LocalizationResult run(LocalizerPool::Job& job);
  void check_database(const LocalizerPool::Job& job);
  void check_acknowledgements(const LocalizationResult& answer);
  double uniform() { return std::uniform_real_distribution<double>()(random_); }

  std::string name_;
  Incarnation incarnation_;
  SentRecord& record_;
  std::mt19937 random_;
  std::unique_ptr<Channel> channel_;
  LocalizerPool pool_;
  double job_time_s_ = 0.04;
  Timestamp paused_until_{};
  std::multimap<Timestamp, Running> running_;
  std::map<RobotId, Stream> streams_;
};

}  // namespace fleetloc
