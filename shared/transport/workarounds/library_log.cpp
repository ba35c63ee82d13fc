#include "shared/transport/workarounds/library_log.hpp"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include <fastdds/dds/log/Log.hpp>

namespace fleetloc {
namespace {

using eprosima::fastdds::dds::Log;
using eprosima::fastdds::dds::LogConsumer;

constexpr std::size_t kRecent = 32;

struct Record {
  std::mutex mutex;
  LibraryLog log;  // guarded by mutex
};

/// Runs on the library's log thread.
class Recorder final : public LogConsumer {
 public:
  explicit Recorder(std::shared_ptr<Record> record) : record_(std::move(record)) {}

  void Consume(const Log::Entry& entry) override {
    const std::lock_guard lock(record_->mutex);
    LibraryLog& log = record_->log;
    if (entry.kind == Log::Kind::Error) {
      ++log.errors;
      log.recent_errors.push_back(entry.message);
      if (log.recent_errors.size() > kRecent) log.recent_errors.pop_front();
    } else {
      ++log.warnings;
      log.last_warning = entry.message;
    }
  }

 private:
  std::shared_ptr<Record> record_;
};

std::shared_ptr<Record> take_over_log() {
  auto record = std::make_shared<Record>();
  Log::ClearConsumers();
  Log::RegisterConsumer(std::make_unique<Recorder>(record));
  Log::SetVerbosity(Log::Kind::Warning);
  return record;
}

}  // namespace

LibraryLog library_log() {
  static const std::shared_ptr<Record> record = take_over_log();
  Log::Flush();
  const std::lock_guard lock(record->mutex);
  return record->log;
}

std::string first_error_since(const LibraryLog& before) {
  const LibraryLog now = library_log();
  const std::size_t known = now.recent_errors.size();
  const std::size_t added = std::min<std::size_t>(now.errors - before.errors, known);
  return added == 0 ? "" : now.recent_errors[known - added];
}

}  // namespace fleetloc
