#include "shared/compact/answer_sample.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <idl/localization.h>

#include "shared/compact/compact_root.hpp"
#include "shared/compact/correction_block.hpp"
#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"

namespace fleetloc {
namespace {

// The enumerations list the same values in the same order.
static_assert(static_cast<int>(LocalizationStatus::kLocalized) == wire::LOCALIZED);
static_assert(static_cast<int>(LocalizationStatus::kNeedFull) == wire::NEED_FULL);
static_assert(static_cast<int>(LocalizationStatus::kSearching) == wire::SEARCHING);
static_assert(static_cast<int>(LocalizationStatus::kTooFewKeyframes) == wire::TOO_FEW_KEYFRAMES);
static_assert(static_cast<int>(LocalizationStatus::kNoMapCoverage) == wire::NO_MAP_COVERAGE);
static_assert(static_cast<int>(LocalizationStatus::kTooFewMatches) == wire::TOO_FEW_MATCHES);
static_assert(static_cast<int>(LocalizationStatus::kNotConverged) == wire::NOT_CONVERGED);
static_assert(static_cast<int>(LocalizationStatus::kPoorFit) == wire::POOR_FIT);
static_assert(static_cast<int>(LocalizationStatus::kDegenerate) == wire::DEGENERATE);
static_assert(static_cast<int>(LocalizationStatus::kUnconfirmed) == wire::UNCONFIRMED);
static_assert(static_cast<int>(LocalizationStatus::kLost) == wire::LOST);
static_assert(static_cast<int>(LocalizationStatus::kAmbiguous) == wire::AMBIGUOUS);

constexpr std::size_t kMaxAnswerBlock = 1000;
constexpr std::uint32_t kLongest_ms = 3'600'000;
constexpr double kUnitsPerQuaternion = 1 << 30;

CompactRoot<6> information_root(const wire::LocalizationResult& sample) {
  return {.scales = sample.information_scale(), .entries = sample.information_root()};
}

Eigen::Vector4d rotation_of(const wire::LocalizationResult& sample) {
  const auto& q = sample.rotation();
  return Eigen::Vector4d(q[0], q[1], q[2], q[3]) / kUnitsPerQuaternion;
}

Validity check_answer_sample(const wire::LocalizationResult& sample) {
  if (sample.status() > wire::AMBIGUOUS) return unexpected(Malformed::kUnknownValue);
  if (const Validity valid = check_stamp(sample.stamp_ns()); !valid) return valid;
  if (sample.window_ms() > kLongest_ms || sample.holding_time_ms() > kLongest_ms) {
    return unexpected(Malformed::kOutOfRange);
  }
  if (sample.corrections().size() > kMaxAnswerBlock) return unexpected(Malformed::kTooManyItems);
  if (sample.status() != wire::LOCALIZED) return {};
  for (const double value : sample.p_map()) {
    if (const Validity valid = check(value, -kMaxCoordinate, kMaxCoordinate); !valid) return valid;
  }
  if (std::abs(rotation_of(sample).norm() - 1.0) > kUnitNormTolerance) {
    return unexpected(Malformed::kNotARotation);
  }
  const CompactRoot<6> root = information_root(sample);
  if (const Validity valid = root.check(); !valid) return valid;
  if (!root.squared().inverse().allFinite()) return unexpected(Malformed::kOutOfRange);
  return {};
}

std::uint32_t milliseconds(Duration duration) {
  const double ms = std::round(1e3 * to_seconds(duration));
  if (!(ms >= 0.0 && ms <= kLongest_ms)) throw NotEncodable("a duration in an answer");
  return static_cast<std::uint32_t>(ms);
}

// The compact root has entries of 1/127: what is tight beside a direction that is this many times
// looser is told as less tight, or else the loose one would get lost.
Matrix6d tellable(Matrix6d covariance) {
  constexpr double kLargestRatio = 24.0;
  for (const int group : {0, 3}) {
    auto block = covariance.block<3, 3>(group, group);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(block);
    const double least = eigen.eigenvalues()[2] / (kLargestRatio * kLargestRatio);
    const Eigen::Vector3d added = (least - eigen.eigenvalues().array()).max(0.0);
    block += eigen.eigenvectors() * added.asDiagonal() * eigen.eigenvectors().transpose();
  }
  return covariance;
}

void set_pose(const LocalizationResult& result, wire::LocalizationResult& sample) {
  const Eigen::Quaterniond q = result.T_map_body.R.normalized();
  const Eigen::Vector3d& p = result.T_map_body.p;
  sample.p_map({p.x(), p.y(), p.z()});
  const auto units = [](double value) {
    return static_cast<std::int32_t>(std::lround(value * (kUnitsPerQuaternion - 1.0)));
  };
  sample.rotation({units(q.w()), units(q.x()), units(q.y()), units(q.z())});
  const auto root = CompactRoot<6>::of(tellable(result.covariance).inverse());
  sample.information_scale(root.scales);
  sample.information_root(root.entries);
}

wire::LocalizationResult sample_of(const LocalizationResult& result) {
  expect_encodable_id(result.robot);
  expect_encodable_id(result.localizer);
  wire::LocalizationResult sample;
  sample.robot(result.robot);
  sample.localizer(result.localizer);
  sample.session(static_cast<std::uint32_t>(result.session));
  sample.incarnation(static_cast<std::uint32_t>(result.incarnation));
  sample.number(result.number);
  sample.acknowledged_base(static_cast<std::uint32_t>(result.acknowledgements.base));
  sample.acknowledged_bitmap(result.acknowledgements.bitmap);
  sample.status(static_cast<wire::LocalizationStatus>(result.status));
  sample.keyframe(static_cast<std::uint32_t>(result.keyframe));
  sample.revision(static_cast<std::uint32_t>(result.revision));
  sample.stamp_ns(to_wire(result.stamp));
  sample.holding_time_ms(milliseconds(result.holding_time));
  sample.map_hash(result.map_hash);
  if (result.status != LocalizationStatus::kLocalized) {
    sample.places(static_cast<std::uint8_t>(std::clamp(result.places, 0, 255)));
    return sample;
  }
  const Duration window = result.stamp - result.oldest_stamp;
  sample.window_ms(
      milliseconds(std::min<Duration>(window, std::chrono::milliseconds(kLongest_ms))));
  set_pose(result, sample);
  return sample;
}

// Landmarks stay in the order of their ids. Expects that there is something.
void drop_least_useful(Correction& correction) {
  constexpr std::size_t kFewLandmarks = 12;
  auto& landmarks = correction.landmarks;
  auto& poses = correction.relative_poses;
  if (landmarks.size() > kFewLandmarks || poses.empty()) {
    landmarks.erase(std::ranges::min_element(
        landmarks, {}, [](const auto& landmark) { return landmark.information.trace(); }));
  } else {
    poses.erase(poses.begin());
  }
}

}  // namespace

Bytes encode(const Answer& answer, std::size_t max_payload_bytes) {
  wire::LocalizationResult sample = sample_of(answer.result);
  expect_encodable(check_answer_sample(sample), "answer");
  Bytes bytes = to_cdr(sample);
  if (!answer.correction) return bytes;
  const std::size_t envelope = bytes.size();
  const std::size_t room =
      max_payload_bytes > envelope ? std::min(max_payload_bytes - envelope, kMaxAnswerBlock) : 0;
  Correction correction = *answer.correction;
  auto block = encode_corrections(correction);
  constexpr std::size_t kBytesPerItem = 16;  // about; several are dropped before the next look
  while (block.size() > room &&
         correction.landmarks.size() + correction.relative_poses.size() > 0) {
    const std::size_t excess = 1 + (block.size() - room) / kBytesPerItem;
    for (std::size_t i = 0;
         i < excess && correction.landmarks.size() + correction.relative_poses.size() > 0;
         ++i) {
      drop_least_useful(correction);
    }
    block = encode_corrections(correction);
  }
  if (correction.landmarks.empty() && correction.relative_poses.empty()) return bytes;
  sample.corrections(std::move(block));
  return to_cdr(sample);
}

Decoded<Answer> decode_answer(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::LocalizationResult>(bytes, 2, check_answer_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  const Timestamp stamp = stamp_from_wire(sample.stamp_ns());
  const auto milli = [](std::uint32_t ms) { return Duration{std::int64_t{ms} * 1'000'000}; };
  Answer answer{.result = {.robot = sample.robot().to_string(),
                           .session = SessionNumber{sample.session()},
                           .localizer = sample.localizer().to_string(),
                           .incarnation = Incarnation{sample.incarnation()},
                           .number = sample.number(),
                           .acknowledgements = {.base = SampleNumber{sample.acknowledged_base()},
                                                .bitmap = sample.acknowledged_bitmap()},
                           .status = static_cast<LocalizationStatus>(sample.status()),
                           .keyframe = KeyframeId{sample.keyframe()},
                           .revision = Revision{sample.revision()},
                           .stamp = stamp,
                           .places = sample.places(),
                           .oldest_stamp = stamp - milli(sample.window_ms()),
                           .map_hash = sample.map_hash(),
                           .T_map_body = {},
                           .holding_time = milli(sample.holding_time_ms())},
                .correction = {}};
  if (answer.result.status == LocalizationStatus::kLocalized) {
    const Eigen::Vector4d q = rotation_of(sample).normalized();
    const auto& p = sample.p_map();
    answer.result.T_map_body = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]), {p[0], p[1], p[2]}};
    answer.result.covariance = information_root(sample).squared().inverse();
  }
  if (sample.corrections().empty()) return answer;
  answer.correction = decode_corrections(sample.corrections(), answer.result.keyframe);
  if (!answer.correction) return unexpected(Malformed::kUndecodable);
  Correction& correction = *answer.correction;
  correction.robot = answer.result.robot;
  correction.session = answer.result.session;
  correction.localizer = answer.result.localizer;
  correction.incarnation = answer.result.incarnation;
  return answer;
}

}  // namespace fleetloc
