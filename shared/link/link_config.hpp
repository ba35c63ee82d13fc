#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "shared/config/config_reader.hpp"
#include "shared/link/outages.hpp"
#include "shared/link/rate_trace.hpp"

namespace fleetloc {

/// One direction of a link. Times count from the first datagram of either direction.
struct LinkDirection {
  double loss{};                ///< share of the datagrams
  double delay_s{};             ///< one way
  double rate_bytes_per_s{};    ///< 0: unlimited
  std::size_t queue_bytes{};    ///< before the rate limit; what does not fit is dropped
  double burst_length{1.0};     ///< datagrams that share a fate, mean; 1: losses are independent
  double jitter_s{};            ///< mean of an exponential extra delay
  double reordering{};          ///< share of the datagrams that take `reordering_delay_s` longer
  double reordering_delay_s{};  ///< above 0 with a share
  double duplication{};         ///< share of those that arrive that arrive twice
  RateTrace rate_trace{};       ///< beside `rate_bytes_per_s`: the smaller counts
  Outages outages{};            ///< what leaves the bottleneck in one is lost
};

/// The link of one robot, seen from it.
struct LinkConfig {
  LinkDirection uplink{}, downlink{};
  std::uint64_t seed{};
};

/// No loss, no delay, no limit.
LinkConfig perfect_link();

/// Reads `seed`, and `uplink` and `downlink` with `loss` (0..1), `delay_s` (0..3600),
/// `rate_bytes_per_s` (0: unlimited, else >= 1), `queue_bytes` (with a rate at least 1500, so that
/// a datagram fits), and what else a file names of read_impairments(). Anything missing, unknown or
/// out of range is a ConfigError.
/// @param folder  that the files of traces are relative to
LinkConfig read_link_config(ConfigReader config, const std::filesystem::path& folder = {});
LinkConfig read_link_file(const std::filesystem::path& file);

/// Reads those that are there of `burst_length` (>= 1), `jitter_s`, `reordering`,
/// `reordering_delay_s`, `duplication`, `rate_trace: [[time_s, bytes_per_s], ...]` or
/// `rate_trace_file` (lines `time_s, bytes_per_s`), `rate_trace_repeat_s`, `outages: [[from_s,
/// for_s], ...]` and `periodic_outage: {every_s, from_s, for_s}`.
void read_impairments(ConfigReader& section,
                      const std::filesystem::path& folder,
                      LinkDirection& direction);

/// What a queue holds where nothing else is said: two seconds of the (largest) rate, and not less
/// than 8000 bytes.
std::size_t default_queue_bytes(const LinkDirection& direction);

/// The file that read_link_file() reads, traces included.
std::string link_yaml(const LinkConfig& link);

}  // namespace fleetloc
