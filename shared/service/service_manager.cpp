#include "shared/service/service_manager.hpp"

#include <cstdint>

#include <systemd/sd-daemon.h>

namespace fleetloc {
namespace {

constexpr int kKeepEnvironment = 0;

void notify(const std::string& state) {
  static_cast<void>(sd_notify(kKeepEnvironment, state.c_str()));  // nobody listens: nothing to do
}

}  // namespace

ServiceManager::ServiceManager() {
  std::uint64_t watchdog_us = 0;
  if (sd_watchdog_enabled(kKeepEnvironment, &watchdog_us) <= 0) return;
  feed_interval_ = std::chrono::microseconds(watchdog_us / 4);
}

void ServiceManager::ready() {
  notify("READY=1");
}

void ServiceManager::alive(ArrivalTime now) {
  if (!feed_interval_ || (fed_ && now - *fed_ < *feed_interval_)) return;
  fed_ = now;
  notify("WATCHDOG=1");
}

void ServiceManager::status(const std::string& text, ArrivalTime now) {
  constexpr std::chrono::seconds kInterval(1);
  if (text == status_ || (told_ && now - *told_ < kInterval)) return;
  status_ = text;
  told_ = now;
  notify("STATUS=" + text);
}

void ServiceManager::stopping() {
  notify("STOPPING=1");
}

}  // namespace fleetloc
