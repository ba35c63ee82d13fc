#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

#include "shared/model/served_robot.hpp"
#include "shared/model/session.hpp"
#include "shared/transport/participant.hpp"
#include "shared/transport/reader_thread.hpp"

namespace fleetloc {

/// The end of those who watch the fleet: hears all localizers of a domain, see FleetWriter.
/// load_monitor_profiles() first.
class FleetReader {
 public:
  using News = std::variant<ServedRobot, LocalizerStatus>;

  /// Throws TransportError.
  explicit FleetReader(std::uint32_t domain, const std::optional<FleetKeys>& keys = std::nullopt);

  /// What has arrived since the last call and is well-formed, oldest first; the latest 10,000.
  std::vector<News> take();
  /// Samples that were not.
  [[nodiscard]] std::uint64_t refused() const;

 private:
  bool take_from(eprosima::fastdds::dds::DataReader& reader);

  Participant participant_;
  EntityPtr<eprosima::fastdds::dds::DataReader> robots_;
  EntityPtr<eprosima::fastdds::dds::DataReader> localizers_;
  mutable std::mutex mutex_;
  std::deque<News> news_;
  std::uint64_t refused_ = 0;
  ReaderThread thread_;  // last: uses the others
};

}  // namespace fleetloc
