#pragma once

#include <map>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "shared/link/channel.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/session.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// What samples say, by the names of shared/model, in SI units; rotations are w x y z. A sample
/// that the receiver would refuse has an `error` that says why.
///
/// A compact submap can be decoded only with the calibration of its session, so sessions have to be
/// given, too; without one its `block` is only a number of bytes.
class SampleDecoder {
 public:
  using Json = nlohmann::ordered_json;

  /// @param topic  its name
  Json decode(std::string_view topic, const Bytes& payload);

 private:
  Json decode_session(const Bytes& payload);
  [[nodiscard]] Json decode_compact(const Bytes& payload) const;

  std::map<RobotId, RobotSession> sessions_;  // the latest of each robot
};

}  // namespace fleetloc
