#pragma once

#include <atomic>
#include <cstdint>

namespace fleetloc {

/// Traffic at the IP level, with all headers, and with the meta traffic of DDS.
struct WireTraffic {
  std::uint64_t sent_bytes = 0;      ///< before the emulated link
  std::uint64_t received_bytes = 0;  ///< behind it
  std::uint64_t sent_datagrams = 0;
  std::uint64_t received_datagrams = 0;
};

/// Counts datagrams. Any thread may use any function.
class TrafficCounter {
 public:
  /// @param bytes   payload of UDP
  /// @param copies  of it, each to another address
  void sent(std::uint32_t bytes, std::uint64_t copies);
  void received(std::uint32_t bytes);

  /// Each number for itself is exact; together they may be from different moments.
  [[nodiscard]] WireTraffic total() const;

 private:
  // On a cache line of its own: the threads that receive do not wait for those that send.
  struct alignas(64) Direction {
    std::atomic<std::uint64_t> bytes = 0;
    std::atomic<std::uint64_t> datagrams = 0;

    void add(std::uint32_t each, std::uint64_t count);
  };

  Direction sent_, received_;
};

}  // namespace fleetloc
