#include "cloud/pool/admission.hpp"

#include <algorithm>
#include <cmath>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr double kHalfLifeSeconds = 2.0;  // of the longest wait

}  // namespace

void Admission::waited(Duration wait, Timestamp now) {
  if (!faded_) faded_ = now;
  wait_s_ = std::max(wait_s_, to_seconds(wait));
}

bool Admission::update(double load, Sessions sessions, Timestamp now) {
  if (faded_) wait_s_ *= std::exp2(-to_seconds(now - *faded_) / kHalfLifeSeconds);
  faded_ = now;
  const double expected = expected_load(load, sessions);
  if (is_open_) {
    is_open_ = expected < config_.max_load && wait_s_ < config_.max_wait_s;
  } else {
    is_open_ = expected < config_.open_load && wait_s_ < config_.open_wait_s;
  }
  return is_open_;
}

double Admission::expected_load(double load, Sessions sessions) const {
  const int measured = sessions.all - sessions.fresh;
  const double of_one = measured > 0 ? load / measured : config_.session_load;
  return measured > 0 ? load + sessions.fresh * of_one : std::max(load, sessions.fresh * of_one);
}

Admission::Config read_admission_config(ConfigReader config) {
  return {.max_load = config.positive("max_load"),
          .open_load = config.positive("open_load"),
          .max_wait_s = config.positive("max_wait_s"),
          .open_wait_s = config.positive("open_wait_s"),
          .new_for_s = config.positive("new_for_s"),
          .session_load = config.positive("session_load")};
}

}  // namespace fleetloc
