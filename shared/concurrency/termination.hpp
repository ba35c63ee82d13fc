#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

#include <pthread.h>

namespace fleetloc {

/// Turns SIGINT and SIGTERM into a stop request. To be made in main before any other thread, which
/// then inherits the blocked signals.
class Termination {
 public:
  Termination() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    thread_ = std::jthread([this] {
      int signal = 0;
      sigwait(&signals_, &signal);
      source_.request_stop();
    });
  }
  ~Termination() {
    pthread_kill(thread_.native_handle(), SIGTERM);  // ends the wait; none arrives if it is over
  }
  Termination(const Termination&) = delete;
  Termination& operator=(const Termination&) = delete;

  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  sigset_t signals_{};
  std::stop_source source_;
  std::jthread thread_;  // last: uses the others
};

}  // namespace fleetloc
