#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace fleetloc {

/// One page over HTTP that shows the fleet while it moves: `/`; `/map`, its points as x, y, z in
/// single precision, little endian; `/events`, server-sent events with what show() was given last.
/// Threads of its own answer.
class FleetPage {
 public:
  /// Throws std::runtime_error that names address and port if it cannot listen there.
  /// @param port  0: any
  FleetPage(const std::string& address, int port, const std::vector<Eigen::Vector3f>& map);
  ~FleetPage();
  FleetPage(const FleetPage&) = delete;
  FleetPage& operator=(const FleetPage&) = delete;

  [[nodiscard]] int port() const { return port_; }

  /// @param json  one line
  void show(std::string json);

 private:
  void send_events(httplib::Response& response);
  /// The next state after `number`, and its number; empty: the page ends.
  std::string next(std::uint64_t& number);

  std::string map_;
  int port_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string json_;
  std::uint64_t number_ = 0;  // of json_
  bool ends_ = false;
  std::unique_ptr<httplib::Server> server_;
  std::jthread thread_;  // last: uses the others
};

}  // namespace fleetloc
