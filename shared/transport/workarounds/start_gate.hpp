#pragma once

// Works around: a participant of Fast DDS 2.9.1 announces itself before it listens
// (RTPSParticipantImpl::enable registers the receivers last). An answer that comes within that
// millisecond is lost, and who has answered does not do so again: the two do not meet before the
// next periodic announcement.
// Delete when: the receivers are registered before the builtin protocols are enabled.

#include <atomic>
#include <functional>
#include <mutex>
#include <vector>

namespace fleetloc {

/// Holds back what a participant sends until it listens.
///
/// No clock, no I/O. Any thread may use any function; while it is open none waits.
class StartGate {
 public:
  using Send = std::function<void()>;

  /// A participant is about to be created. What was held for one that failed is dropped.
  void close();
  /// It listens: what was held is sent, in its order, by this thread.
  void open();

  [[nodiscard]] bool is_closed() const { return is_closed_; }
  /// Holds it; or sends it, if it has been opened meanwhile.
  void hold(Send send);

 private:
  std::atomic<bool> is_closed_ = false;
  std::mutex mutex_;
  std::vector<Send> held_;  // guarded by mutex_
};

}  // namespace fleetloc
