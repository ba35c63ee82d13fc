#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "test/system/child_program.hpp"
#include "test/system/network_namespace.hpp"
#include "test/system/tun_relay.hpp"

namespace fleetloc {

/// Two computers, of robots and of localizers, and a poor line between them that is the kernel's
/// and not ours: its rate by a token bucket (tbf), its loss by a packet filter (nftables), its
/// delay by a relay of packets.
class PoorLine {
 public:
  using Words = std::vector<std::string>;

  /// Either way.
  struct Config {
    int loss_percent = 0;
    std::chrono::milliseconds delay{0};
    int bytes_per_s = 0;  ///< 0: unlimited
  };
  /// At the robots' end of the line, from the beginning [bytes of IP].
  struct Counters {
    double offered = 0.0;   ///< to the interface
    double sent = 0.0;      ///< by it
    double received = 0.0;  ///< by it
    double dropped = 0.0;   ///< of them, on purpose
  };

  /// Why it is not possible here; nothing if it is.
  static std::optional<std::string> why_impossible();

  /// Without loss at first, but what comes to the robots is dropped until let_robots_receive().
  explicit PoorLine(const Config& config);

  [[nodiscard]] std::unique_ptr<ChildProgram> start_for_robots(const char* program,
                                                               const Words& words) const {
    return start(robots_, program, words);
  }
  [[nodiscard]] std::unique_ptr<ChildProgram> start_for_localizers(const char* program,
                                                                   const Words& words) const {
    return start(localizers_, program, words);
  }

  void begin_to_lose() const;

  /// As soon as a program at their end has opened its sockets: what arrives before is received by
  /// the computer, but by no program.
  void let_robots_receive() const;
  [[nodiscard]] Counters counters() const;

 private:
  static std::unique_ptr<ChildProgram> start(const NetworkNamespace& computer,
                                             const char* program,
                                             const Words& words);
  void impair(const NetworkNamespace& computer, const char* other) const;

  Config config_;
  NetworkNamespace robots_;
  NetworkNamespace localizers_;
  TunRelay relay_;
};

}  // namespace fleetloc
