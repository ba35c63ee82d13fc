#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "cloud/pool/pool_refusal.hpp"
#include "shared/model/robot_status.hpp"

namespace fleetloc {

/// The latest values of a series, at most kMax.
class RecentValues {
 public:
  static constexpr std::size_t kMax = 1000;

  void add(double value) {
    if (values_.size() < kMax) {
      values_.push_back(static_cast<float>(value));
    } else {
      values_[next_] = static_cast<float>(value);
      next_ = (next_ + 1) % kMax;
    }
  }

  [[nodiscard]] std::vector<double> values() const { return {values_.begin(), values_.end()}; }

 private:
  std::vector<float> values_;
  std::size_t next_ = 0;  // the oldest, once there are kMax
};

/// Of a robot that was looked for in the map; of its present session.
struct SearchReport {
  std::uint64_t searches = 0;                    ///< of the whole map, that have ended
  double explained = 1.0;                        ///< see FirstPlace
  std::size_t places_left = 0;                   ///< of the latest search
  std::vector<Eigen::Vector3d> possible_places;  ///< see ServedRobot
  /// Of each search, with the places' alignment: of its turns that had no submaps as well. The last
  /// one of a search that has found a place localizes there, too.
  RecentValues ms;
  double running_ms = 0.0;  ///< of the one that has not ended
};

/// Statistics of one robot at this localizer; written to sessions.json.
struct SessionReport {
  std::uint64_t sessions = 0;  ///< opened
  std::uint64_t submaps = 0;
  std::uint64_t localized = 0;
  std::map<std::string, std::uint64_t> rejected;  ///< localizations, by reason
  std::map<std::string, std::uint64_t> refused;   ///< messages and work, by reason
  RecentValues optimize_ms;                       ///< of each localization
  RecentValues matches;                           ///< with the map, of each localization
  std::size_t memory_bytes = 0;                   ///< after the latest localization
  SearchReport search;
  std::string last_error;             ///< what the latest exception said
  std::optional<RobotStatus> status;  ///< the latest

  void refuse(PoolRefusal refusal, std::uint64_t count = 1) {
    if (count > 0) refused[std::string(name(refusal))] += count;
  }
};

}  // namespace fleetloc
