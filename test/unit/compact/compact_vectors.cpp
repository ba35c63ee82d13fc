// Writes samples of the compact encoding, each with the submap or the answer that it is decoded to:
// a line of JSON each, doubles in hexadecimal. decode_submap.py and decode_answer.py have to come
// to the same.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <idl/localization.h>

#include "shared/compact/answer_sample.hpp"
#include "shared/compact/compact_root.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/wire/cdr.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/compact/vector_json.hpp"

namespace fleetloc {
namespace {

std::string hexadecimal(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    out += digits;
  }
  return out;
}

/// Windows of a drive: of one keyframe to ten, whole and halved, some with keyframes that only
/// edges need, and with an edge over many keyframes.
Submap window_of(const Submap& drive, std::uint32_t number) {
  Submap window;
  window.robot = drive.robot;
  window.number = SampleNumber{number};
  const std::size_t size = 1 + number % 10;
  for (std::size_t i = 0; i < size; ++i) {
    window.keyframes.push_back(drive.keyframes[number + i]);
    if (i > 0) window.edges.push_back(drive.edges[number + i - 1]);
    window.keyframes.back().is_reference = number % 3 == 0 && i + 2 < size;
    if (number % 7 == 0) window.keyframes.back().tilt_sigma = kUnknownTiltRad;
  }
  if (size > 4) {
    VirtualEdge wide = window.edges.front();
    wide.to = window.keyframes.back().id;
    wide.T_from_to =
        inverse(window.keyframes.front().T_odom_body) * window.keyframes.back().T_odom_body;
    window.edges.push_back(wide);
  }
  return window;
}

void write_vectors(std::ostream& out) {
  const RectifiedStereo stereo = some_stereo();
  Submap drive = moving_robot(100, 80);
  for (SubmapKeyframe& keyframe : drive.keyframes) {
    if (keyframe.observations.size() > 50) keyframe.observations.resize(50);
  }
  for (std::uint32_t number = 0; number < 60; ++number) {
    const std::uint32_t stride = 1 + number % 2;
    const CompactPrecision precision{.subset = {.stride = stride, .offset = number / 2 % stride},
                                     .step_bits = number % 4};
    const Bytes bytes = encode_compact(window_of(drive, number), {}, precision, stereo);
    const Submap decoded = decode_submap(decode_submap_sample(bytes).value(), stereo).value();
    out << json{{"stereo", stereo_json(stereo)},
                {"sample", hexadecimal(bytes)},
                {"submap", submap_json(decoded)}}
               .dump()
        << '\n';
  }
}

// Numbers of any size, the same in each run: linear congruences (Knuth's MMIX).
class Numbers {
 public:
  double operator()(double low, double high) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * static_cast<double>(state_ >> 11U) / 9007199254740992.0;
  }

 private:
  std::uint64_t state_ = 1;
};

template <int N>
Eigen::Matrix<double, N, N> some_information(Numbers& numbers) {
  Eigen::Matrix<double, N, N> root;
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column < N; ++column) root(row, column) = numbers(-40.0, 40.0);
  }
  root.template leftCols<3>() *= numbers(1.0, 300.0);
  return root.transpose() * root;
}

Pose some_pose(Numbers& numbers, double size) {
  const Eigen::Quaterniond R(numbers(-1, 1), numbers(-1, 1), numbers(-1, 1), numbers(-1, 1));
  return {R.normalized(), {numbers(-size, size), numbers(-size, size), numbers(-size, size)}};
}

/// Answers with and without a pose; of the former, corrections of none to all items.
Answer answer_of(Numbers& numbers, std::uint32_t number) {
  Answer answer;
  answer.result = {.robot = "robot_1",
                   .session = SessionNumber{3},
                   .localizer = "alpha",
                   .incarnation = Incarnation{17},
                   .number = number,
                   .acknowledgements = {SampleNumber{number / 2}, 0x9000'0000'0000'0001U + number},
                   .status = static_cast<LocalizationStatus>(number % 10),
                   .keyframe = KeyframeId{200 + number},
                   .revision = Revision{number},
                   .stamp = Timestamp{Duration{1'000'000'007LL * number}},
                   .places = static_cast<int>(number % 256),
                   .oldest_stamp = Timestamp{Duration{900'000'000LL * number}},
                   .map_hash = {1, 2, 3},
                   .T_map_body = some_pose(numbers, 500.0),
                   .covariance = some_information<6>(numbers).inverse(),
                   .holding_time = std::chrono::milliseconds(number)};
  if (number % 10 != 0) return answer;
  Correction& correction = answer.correction.emplace();
  correction.anchor = answer.result.keyframe;
  for (std::uint32_t i = number / 10 % 7; i > 0; --i) {
    correction.relative_poses.push_back({.from = KeyframeId{200 + number - i},
                                         .to = KeyframeId{201 + number - i},
                                         .T_from_to = some_pose(numbers, 2.0),
                                         .information = some_information<6>(numbers)});
  }
  for (std::uint32_t i = 0; i < number / 10 % 30; ++i) {
    correction.landmarks.push_back({.id = LandmarkId{7000 + 3 * i * number},
                                    .p_anchor = some_pose(numbers, 30.0).p,
                                    .information = some_information<3>(numbers)});
  }
  return answer;
}

// Its fields as they are sent; of the covariance the inverse, which is the same on every machine.
json answer_json(const Bytes& bytes) {
  const auto sample = from_cdr<wire::LocalizationResult>(bytes, 2).value();
  const Answer answer = decode_answer(bytes).value();
  json out{{"robot", sample.robot().to_string()},
           {"localizer", sample.localizer().to_string()},
           {"number", sample.number()},
           {"acknowledged_base", sample.acknowledged_base()},
           {"acknowledged_bitmap", sample.acknowledged_bitmap()},
           {"status", static_cast<std::uint32_t>(sample.status())},
           {"keyframe", sample.keyframe()},
           {"stamp_ns", sample.stamp_ns()},
           {"window_ms", sample.window_ms()},
           {"places", sample.places()}};
  if (answer.result.status == LocalizationStatus::kLocalized) {
    const CompactRoot<6> root{.scales = sample.information_scale(),
                              .entries = sample.information_root()};
    out["p_map"] = texts(sample.p_map());
    out["rotation"] = sample.rotation();
    out["information"] = upper_triangle<6>(root.squared());
  }
  if (answer.correction) out["corrections"] = correction_json(*answer.correction);
  return out;
}

void write_answers(std::ostream& out) {
  Numbers numbers;
  for (std::uint32_t number = 1; number <= 300; ++number) {
    const Bytes bytes = encode(answer_of(numbers, number), 1200);
    out << json{{"sample", hexadecimal(bytes)}, {"answer", answer_json(bytes)}}.dump() << '\n';
  }
}

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: compact_vectors SUBMAPS ANSWERS\n";
    return 2;
  }
  std::ofstream submaps(argv[1]);
  fleetloc::write_vectors(submaps);
  submaps.close();
  std::ofstream answers(argv[2]);
  fleetloc::write_answers(answers);
  answers.close();
  return submaps && answers ? 0 : 1;
}
