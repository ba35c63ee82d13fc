#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

#include <pthread.h>

#include "shared/concurrency/reload_request.hpp"

namespace fleetloc {

/// What SIGHUP asks for.
enum class Hangup {
  kStop,    ///< the terminal is gone
  kReload,  ///< of a service
};

/// Turns SIGINT and SIGTERM into a stop request, a second one into an urgent one. Create it before
/// any other thread, which then inherits the blocked signals. SIGUSR1 is blocked as well, and only
/// wakes the thread.
class Termination {
 public:
  explicit Termination(Hangup hangup = Hangup::kStop) : hangup_(hangup) {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) sigaddset(&signals_, signal);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    thread_ = std::jthread([this](const std::stop_token& done) { watch(done); });
  }
  ~Termination() {
    thread_.request_stop();
    pthread_kill(thread_.native_handle(), SIGUSR1);
  }
  Termination(const Termination&) = delete;
  Termination& operator=(const Termination&) = delete;

  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }
  /// Requested by the second signal: do not wait for anybody.
  [[nodiscard]] std::stop_token urgent_token() const { return urgent_.get_token(); }
  [[nodiscard]] ReloadRequest& reload() { return reload_; }

 private:
  void watch(const std::stop_token& done) {
    while (!done.stop_requested()) {
      int signal = 0;
      sigwait(&signals_, &signal);
      if (signal == SIGUSR1) continue;
      if (signal == SIGHUP && hangup_ == Hangup::kReload) {
        reload_.set();
        continue;
      }
      if (!source_.request_stop()) urgent_.request_stop();
    }
  }

  Hangup hangup_;
  sigset_t signals_{};
  std::stop_source source_;
  std::stop_source urgent_;
  ReloadRequest reload_;
  std::jthread thread_;  // last: uses the others
};

}  // namespace fleetloc
