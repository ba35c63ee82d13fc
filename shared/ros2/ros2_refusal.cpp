#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

std::string_view name(Ros2Refusal reason) {
  switch (reason) {
    case Ros2Refusal::kUndecodable:
      return "undecodable";
    case Ros2Refusal::kInvalidStamp:
      return "invalid_stamp";
    case Ros2Refusal::kLongText:
      return "long_text";
    case Ros2Refusal::kUnknownEncoding:
      return "unknown_encoding";
    case Ros2Refusal::kEmptyImage:
      return "empty_image";
    case Ros2Refusal::kTooManyPixels:
      return "too_many_pixels";
    case Ros2Refusal::kWrongStep:
      return "wrong_step";
    case Ros2Refusal::kWrongLength:
      return "wrong_length";
    case Ros2Refusal::kWrongOrder:
      return "wrong_order";
    case Ros2Refusal::kDamagedImage:
      return "damaged_image";
    case Ros2Refusal::kNotFinite:
      return "not_finite";
    case Ros2Refusal::kOutOfRange:
      return "out_of_range";
    case Ros2Refusal::kNotMeasured:
      return "not_measured";
    case Ros2Refusal::kNotCalibrated:
      return "not_calibrated";
    case Ros2Refusal::kNotARotation:
      return "not_a_rotation";
    case Ros2Refusal::kNotACovariance:
      return "not_a_covariance";
  }
  return "unknown";
}

}  // namespace fleetloc
