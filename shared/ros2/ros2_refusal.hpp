#pragma once

#include <string_view>

#include "shared/core/expected.hpp"

namespace fleetloc {

/// Why a ROS 2 message was refused: whoever may send it is outside the trust boundary.
enum class Ros2Refusal {
  kUndecodable,      ///< not the CDR of this type
  kInvalidStamp,     ///< before 1970, or a second of more than 1e9 ns
  kLongText,         ///< a frame or a name of more than 256 characters
  kUnknownEncoding,  ///< of an image: one that is not read here
  kEmptyImage,
  kTooManyPixels,
  kWrongStep,     ///< a row is shorter than its pixels
  kWrongLength,   ///< the data is not as long as its rows
  kWrongOrder,    ///< of bytes: neither little nor big endian
  kDamagedImage,  ///< a JPEG or PNG that cannot be decoded, or is cut off
  kNotFinite,
  kOutOfRange,
  kNotMeasured,    ///< an IMU that says that it does not measure this
  kNotCalibrated,  ///< a camera without a focal length
  kNotARotation,
  kNotACovariance,  ///< not symmetric, or not positive semi-definite
};

/// Name in logs, diagnostics and summaries.
std::string_view name(Ros2Refusal reason);

template <typename T>
using Ros2Decoded = expected<T, Ros2Refusal>;

/// Of a message or a part of it.
using Ros2Validity = expected<void, Ros2Refusal>;

}  // namespace fleetloc
