#include "shared/config/progress_line.hpp"

#include <cmath>
#include <iostream>
#include <sstream>
#include <utility>

#include <unistd.h>

namespace fleetloc {
namespace {

constexpr const char* kClearLine = "\r\x1b[K";

}  // namespace

ProgressLine::ProgressLine(std::string work)
    : work_(std::move(work)), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (shown_) std::cerr << '\n';
}

void ProgressLine::clear() {
  if (!shown_) return;
  std::cerr << kClearLine << std::flush;
  shown_ = false;
}

void ProgressLine::show(std::size_t done, std::size_t total) {
  constexpr std::chrono::milliseconds kInterval(100);
  if (!terminal_) return;
  const auto now = Clock::now();
  if (shown_ && done < total && now - last_ < kInterval) return;
  std::cerr << kClearLine << progress_text(work_, done, total, now - start_) << std::flush;
  shown_ = true;
  last_ = now;
}

std::string progress_text(const std::string& work,
                          std::size_t done,
                          std::size_t total,
                          std::chrono::duration<double> elapsed) {
  std::ostringstream text;
  text << work << "  " << done << '/' << total;
  if (total > 0) text << "  " << 100 * done / total << " %";
  if (done > 0 && elapsed.count() > 0.0) {
    const double rate = static_cast<double>(done) / elapsed.count();
    text << "  " << std::round(rate * 10.0) / 10.0 << "/s";
    const double left_s = std::ceil(static_cast<double>(total - done) / rate);
    if (done < total) text << "  " << left_s << " s left";
  }
  return text.str();
}

}  // namespace fleetloc
