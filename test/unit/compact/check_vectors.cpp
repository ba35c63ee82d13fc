// Whether this machine decodes the samples of compact_vectors to the same bits as the one that
// wrote them, and codes them to the same bytes again. Needs neither DDS nor CDR, so that
// test/aarch64.sh can build it for another machine.
#include <cstring>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/compact/compact_root.hpp"
#include "shared/compact/correction_block.hpp"
#include "shared/compact/quantization.hpp"
#include "shared/compact/submap_block.hpp"
#include "test/unit/compact/vector_json.hpp"

namespace fleetloc {
namespace {

using Octets = std::vector<std::uint8_t>;

/// Little endian CDR behind its encapsulation.
class Fields {
 public:
  explicit Fields(const std::string& hexadecimal) {
    for (std::size_t i = 8; i + 1 < hexadecimal.size(); i += 2) {
      octets_.push_back(
          static_cast<std::uint8_t>(std::stoi(hexadecimal.substr(i, 2), nullptr, 16)));
    }
  }

  template <typename T>
  T take() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    T value{};
    std::memcpy(&value, octets_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  template <typename Array>
  void take_into(Array& values) {
    for (auto& value : values) value = take<typename Array::value_type>();
  }
  Octets octets() {
    Octets out(take<std::uint32_t>());
    for (auto& octet : out) octet = take<std::uint8_t>();
    return out;
  }

 private:
  Octets octets_;
  std::size_t at_ = 0;
};

double number(const json& text) {
  return std::strtod(text.get<std::string>().c_str(), nullptr);
}

RectifiedStereo stereo_of(const json& from) {
  RectifiedStereo stereo;
  stereo.focal_px = number(from["focal_px"]);
  stereo.center_px = {number(from["center_px"][0]), number(from["center_px"][1])};
  stereo.baseline_m = number(from["baseline_m"]);
  const json& q = from["rotation"];
  const json& p = from["translation"];
  stereo.T_body_cam0 = {Eigen::Quaterniond(number(q[0]), number(q[1]), number(q[2]), number(q[3])),
                        {number(p[0]), number(p[1]), number(p[2])}};
  return stereo;
}

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error(what);
}

// As compact_submap.idl orders the fields.
void check_submap(const json& vector) {
  Fields fields(vector["sample"].get<std::string>());
  const Octets robot = fields.octets();
  std::array<std::uint32_t, 4> session_incarnation_number_answer{};
  fields.take_into(session_incarnation_number_answer);
  fields.take<std::uint8_t>();
  const auto keyframe = fields.take<std::uint32_t>();
  const auto stamp = Timestamp{Duration{fields.take<std::int64_t>()}};
  NewestPose pose;
  fields.take_into(pose.p_odom);
  fields.take_into(pose.rotation);
  const Octets block = fields.octets();
  const RectifiedStereo stereo = stereo_of(vector["stereo"]);

  const auto coded = decode_block(block, rotation_of(pose), keyframe, stereo);
  expect(coded.has_value(), "a block that cannot be decoded");
  const SampleNumber sample{session_incarnation_number_answer[2]};
  Submap submap = submap_of(*coded, pose, stamp, sample);
  submap.robot = std::string(robot.begin(), robot.end() - 1);
  submap.number = sample;
  expect(submap_json(submap) == vector["submap"], "a submap with other bits");
  expect(encode_block(*coded, stereo) == block, "a block that is coded to other bytes");
}

// As localization.idl orders the fields.
void check_answer(const json& vector) {
  Fields fields(vector["sample"].get<std::string>());
  fields.octets();  // robot, localizer
  fields.octets();
  for (int i = 0; i < 4; ++i) fields.take<std::uint32_t>();
  fields.take<std::uint64_t>();
  const auto status = fields.take<std::uint32_t>();
  const KeyframeId keyframe{fields.take<std::uint32_t>()};
  fields.take<std::uint32_t>();
  fields.take<std::int64_t>();
  for (int i = 0; i < 2; ++i) fields.take<std::uint32_t>();
  for (int i = 0; i < 16; ++i) fields.take<std::uint8_t>();
  for (int i = 0; i < 3; ++i) fields.take<double>();
  for (int i = 0; i < 4; ++i) fields.take<std::int32_t>();
  CompactRoot<6> root;
  fields.take_into(root.scales);
  fields.take_into(root.entries);
  const json& answer = vector["answer"];
  expect(fields.take<std::uint8_t>() == answer["places"], "another number of places");
  if (status == 0) {
    expect(upper_triangle<6>(root.squared()) == answer["information"],
           "an information with other bits");
  }
  const Octets block = fields.octets();
  if (block.empty()) return;
  const auto correction = decode_corrections(block, keyframe);
  expect(correction.has_value(), "corrections that cannot be decoded");
  expect(correction_json(*correction) == answer["corrections"], "corrections with other bits");
}

template <typename Check>
int check_all(const std::string& file, const Check& check) {
  std::ifstream lines(file);
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    ++count;
    try {
      check(json::parse(line));
    } catch (const std::exception& error) {
      throw std::runtime_error(file + ":" + std::to_string(count) + ": " + error.what());
    }
  }
  expect(count > 0, file + ": no samples");
  return count;
}

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: check_vectors SUBMAPS ANSWERS\n";
    return 2;
  }
  try {
    const int submaps = fleetloc::check_all(argv[1], fleetloc::check_submap);
    const int answers = fleetloc::check_all(argv[2], fleetloc::check_answer);
    std::cout << submaps << " submaps and " << answers << " answers have the same bits here\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
