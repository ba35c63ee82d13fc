#include <array>
#include <string>

#include "deploy/topic/sample_decoder.hpp"
#include "deploy/topic/sample_text.hpp"
#include "shared/transport/topics.hpp"
#include "shared/wire/session_codec.hpp"
#include "test/fuzz/target.hpp"

namespace fleetloc {
namespace {

std::string name_of_topic(Topic topic) {
  return topic_spec(topic, "cloud").name;
}

/// That of the compact submaps among the seeds, which nobody can read without it.
Bytes known_session() {
  RobotSession session{};
  session.robot = "robot_1";
  session.session = SessionNumber{3};
  session.localizer = "cloud";
  session.stereo.focal_px = 458.0;
  session.stereo.center_px = {1024.0, 1024.0};
  session.stereo.baseline_m = 0.11;
  return encode(session);
}

}  // namespace
}  // namespace fleetloc

/// As a tool prints what it hears. The first byte chooses the topic, the sample follows.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  static const std::array<std::string, 7> topics{name_of_topic(Topic::kSession),
                                                 name_of_topic(Topic::kSubmap),
                                                 name_of_topic(Topic::kCompactSubmap),
                                                 name_of_topic(Topic::kLocalization),
                                                 name_of_topic(Topic::kRobotStatus),
                                                 name_of_topic(Topic::kLocalizerStatus),
                                                 "fleetloc/pose"};
  static const Bytes session = known_session();
  if (size == 0) return 0;
  SampleDecoder decoder;
  decoder.decode(topics[0], session);
  const Bytes payload(data + 1, data + size);
  const auto json = decoder.decode(topics[data[0] % topics.size()], payload);
  require(!sample_text(json).empty(), "a sample has a text");
  return 0;
}
