#include "cloud/node/status_log.hpp"

#include <stdexcept>

namespace fleetloc {
namespace {

const char* state_of(const LocalizerStatus& status) {
  if (status.draining) return "draining";
  return status.accepting ? "accepting" : "full";
}

}  // namespace

StatusLog::StatusLog(const std::filesystem::path& file, Timestamp start)
    : file_(file), start_(start) {
  open();
}

void StatusLog::open() {
  stream_ = std::ofstream(file_);
  stream_ << "time_s,sessions,load,submaps,localized,state\n" << std::flush;
  if (!stream_) throw std::runtime_error(file_.string() + ": cannot be written");
}

void StatusLog::begin_anew() {
  std::filesystem::path before = file_;
  before += ".1";
  std::filesystem::rename(file_, before);
  open();
}

void StatusLog::add(const LocalizerPool& pool, double load, Timestamp now) {
  constexpr double kInterval_s = 1.0;
  if (written_ && to_seconds(now - *written_) < kInterval_s) return;
  written_ = now;
  std::uint64_t submaps = 0;
  std::uint64_t localized = 0;
  for (const auto& [robot, report] : pool.reports()) {
    submaps += report.submaps;
    localized += report.localized;
  }
  stream_ << to_seconds(now - start_) << ',' << pool.sessions() << ',' << load << ',' << submaps
          << ',' << localized << ',' << state_of(pool.status()) << '\n'
          << std::flush;
  if (!stream_) throw std::runtime_error(file_.string() + ": cannot be written; is the disk full?");
  constexpr std::streamoff kMaxBytes = 20'000'000;
  if (stream_.tellp() > kMaxBytes) begin_anew();
}

}  // namespace fleetloc
