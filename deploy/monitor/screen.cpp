#include "deploy/monitor/screen.hpp"

#include <algorithm>
#include <iostream>
#include <string>

#include <unistd.h>

namespace fleetloc {

Screen::Screen() : is_terminal_(isatty(STDOUT_FILENO) == 1) {}

std::chrono::milliseconds Screen::interval() const {
  return is_terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(10);
}

void Screen::show(const FleetView& view) {
  if (!is_terminal_) {
    const std::string text = line(view);
    std::cout << (text.empty() ? "nobody yet" : text) << '\n' << std::flush;
    return;
  }
  if (lines_ > 0) std::cout << "\x1b[" << lines_ << "A\x1b[J";  // up, and clear from there on
  const std::string text = table(view);
  lines_ = std::ranges::count(text, '\n');
  std::cout << text << std::flush;
}

}  // namespace fleetloc
