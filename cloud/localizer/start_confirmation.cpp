#include "cloud/localizer/start_confirmation.hpp"

namespace fleetloc {

bool StartConfirmation::take(const Pose& T_map_body,
                             const Pose& T_odom_body,
                             double travelled_m,
                             bool is_confident) {
  if (confirmed_) return true;
  const bool stays =
      candidate_ &&
      ((candidate_->T_map_odom * T_odom_body).p - T_map_body.p).norm() <= config_.tolerance_m;
  last_T_map_odom_ = T_map_body * inverse(T_odom_body);
  if (!stays) candidate_ = {*last_T_map_odom_, travelled_m};
  confirmed_ = is_confident || travelled_m - candidate_->travelled_m >= config_.path_m;
  if (confirmed_) last_T_map_odom_.reset();
  return confirmed_;
}

StartConfirmation::Config read_start_confirmation_config(ConfigReader section) {
  return {.path_m = section.positive("path_m"), .tolerance_m = section.positive("tolerance_m")};
}

}  // namespace fleetloc
