#include "shared/wire/correction_codec.hpp"

#include <algorithm>
#include <limits>

#include <idl/correction.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

Correction round_trip(const Correction& sent) {
  return decode_correction(encode(sent)).value();
}

void expect_correction_refused(Malformed reason,
                               const std::function<void(wire::Correction&)>& corrupt) {
  expect_refused<wire::Correction>(some_correction(), decode_correction, reason, corrupt);
}

// Entries against the root of the diagonal entries of their columns' groups.
template <typename Matrix>
void expect_nearly(const Matrix& a, const Matrix& b) {
  const auto size = [&](Eigen::Index i) {
    return std::sqrt(b.diagonal().segment(3 * (i / 3), 3).maxCoeff());
  };
  for (Eigen::Index i = 0; i < b.rows(); ++i) {
    for (Eigen::Index j = 0; j < b.cols(); ++j) {
      EXPECT_NEAR(a(i, j), b(i, j), 0.05 * size(i) * size(j) + 1e-12) << i << " " << j;
    }
  }
}

TEST(CorrectionCodec, RoundTripPreservesEveryField) {
  const Correction sent = some_correction();
  const Correction received = round_trip(sent);
  EXPECT_EQ(received.robot, sent.robot);
  EXPECT_EQ(received.session, sent.session);
  EXPECT_EQ(received.localizer, sent.localizer);
  EXPECT_EQ(received.incarnation, sent.incarnation);
  EXPECT_EQ(received.anchor, sent.anchor);
  ASSERT_EQ(received.relative_poses.size(), sent.relative_poses.size());
  for (std::size_t i = 0; i < sent.relative_poses.size(); ++i) {
    EXPECT_EQ(received.relative_poses[i].from, sent.relative_poses[i].from);
    EXPECT_EQ(received.relative_poses[i].to, sent.relative_poses[i].to);
    expect_near(received.relative_poses[i].T_from_to, sent.relative_poses[i].T_from_to, 4e-9, 6e-6);
    expect_nearly(received.relative_poses[i].information, sent.relative_poses[i].information);
  }
  ASSERT_EQ(received.landmarks.size(), sent.landmarks.size());
  for (std::size_t i = 0; i < sent.landmarks.size(); ++i) {
    EXPECT_EQ(received.landmarks[i].id, sent.landmarks[i].id);
    EXPECT_LE((received.landmarks[i].p_anchor - sent.landmarks[i].p_anchor).cwiseAbs().maxCoeff(),
              1e-3);
    expect_nearly(received.landmarks[i].information, sent.landmarks[i].information);
  }
}

TEST(CorrectionCodec, TellsNothingAcrossTheNormalOfAPlane) {
  Correction sent = some_correction(1);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.8, -0.5, 0.3).normalized();
  sent.landmarks[0].information = 1e4 * normal * normal.transpose();
  const Eigen::Matrix3d received = round_trip(sent).landmarks[0].information;
  const Eigen::Vector3d along = normal.cross(Eigen::Vector3d::UnitX()).normalized();
  EXPECT_NEAR(normal.dot(received * normal), 1e4, 300.0);
  EXPECT_LT(along.dot(received * along), 2.0);
}

TEST(CorrectionCodec, FitsOneDatagramWithTheMostInformativeLandmarks) {
  for (const std::uint32_t gap : {1U, 300U}) {
    const Correction sent = some_correction(100, gap);
    const Bytes bytes = encode(sent);
    EXPECT_LE(bytes.size(), kMaxCorrectionBytes);
    EXPECT_GT(bytes.size(), kMaxCorrectionBytes - 40);
    const Correction received = decode_correction(bytes).value();
    EXPECT_EQ(received.relative_poses.size(), 7U);
    EXPECT_GE(received.landmarks.size(), gap == 1U ? 40U : 30U);
    std::printf(
        "gap %u: %zu landmarks in %zu bytes\n", gap, received.landmarks.size(), bytes.size());
    // Their information increases with their place.
    const auto kept = static_cast<std::ptrdiff_t>(received.landmarks.size());
    EXPECT_GE(received.landmarks.front().id, (sent.landmarks.end() - kept - 3)->id);
  }
  Correction poses = some_correction(0);
  poses.robot = std::string(32, 'r');
  poses.localizer = std::string(32, 'l');
  poses.relative_poses.clear();
  for (std::uint32_t i = 0; i < kMaxCorrectedPoses; ++i) {
    poses.relative_poses.push_back(
        {KeyframeId{i}, KeyframeId{i + 1}, some_pose(0.1), some_matrix()});
  }
  EXPECT_LE(encode(poses).size(), kMaxCorrectionBytes);
}

TEST(CorrectionCodec, RefusesWithAReason) {
  using enum Malformed;
  expect_correction_refused(kInvalidId, [](auto& sample) { sample.robot("?"); });
  expect_correction_refused(kInvalidId, [](auto& sample) { sample.localizer(""); });
  expect_correction_refused(kTooManyItems, [](auto& sample) { sample.pose_from().resize(17); });
  expect_correction_refused(kTooManyItems, [](auto& sample) { sample.landmark_id().resize(129); });
  expect_correction_refused(kUnequalColumns, [](auto& sample) { sample.pose_scale().pop_back(); });
  expect_correction_refused(kUnequalColumns,
                            [](auto& sample) { sample.landmark_id_wide().push_back(1); });
  expect_correction_refused(kUnequalColumns,
                            [](auto& sample) { sample.landmark_information().pop_back(); });
  expect_correction_refused(kUnorderedItems,
                            [](auto& sample) { sample.pose_from()[0] = sample.pose_to()[0]; });
  expect_correction_refused(kUnorderedItems,
                            [](auto& sample) { sample.pose_to()[1] = sample.pose_to()[0]; });
  expect_correction_refused(kUnorderedItems, [](auto& sample) { sample.anchor(99'990); });
  expect_correction_refused(kNotARotation, [](auto& sample) { sample.pose_rotation()[0] /= 2; });
  expect_correction_refused(kOutOfRange, [](auto& sample) { sample.pose_information()[5] = 0; });
  expect_correction_refused(kOutOfRange, [](auto& sample) { sample.pose_scale()[3] = 241; });
  expect_correction_refused(kOutOfRange, [](auto& sample) {
    std::ranges::fill(sample.landmark_information(), std::uint8_t{255});
  });
  expect_correction_refused(kOutOfRange,
                            [](auto& sample) { sample.landmark_position()[0] = -32'501; });
  expect_correction_refused(kUnorderedItems, [](auto& sample) {
    sample.landmark_id()[1] = 0;
    sample.landmark_id_wide().push_back(3);
  });
}

TEST(CorrectionCodec, RefusesToEncodeWhatTheReceiverWouldRefuse) {
  const auto expect_not_encodable = [](const std::function<void(Correction&)>& corrupt) {
    Correction correction = some_correction();
    corrupt(correction);
    EXPECT_THROW(encode(correction), NotEncodable);
  };
  expect_not_encodable([](Correction& c) { c.robot = ""; });
  expect_not_encodable([](Correction& c) { c.localizer = "a b"; });
  expect_not_encodable([](Correction& c) {
    c.relative_poses.clear();
    c.landmarks.clear();
  });
  expect_not_encodable([](Correction& c) { c.landmarks[0].p_anchor.x() = 66.0; });
  expect_not_encodable([](Correction& c) { std::swap(c.landmarks[0], c.landmarks[1]); });
  expect_not_encodable([](Correction& c) { c.landmarks[3].information(0, 0) = -1.0; });
  expect_not_encodable([](Correction& c) { c.landmarks[3].information(0, 1) += 1e3; });
  expect_not_encodable([](Correction& c) {
    c.relative_poses[0].information(2, 2) = std::numeric_limits<double>::quiet_NaN();
  });
  expect_not_encodable([](Correction& c) { c.relative_poses[0].information *= 1e20; });
  expect_not_encodable([](Correction& c) { c.relative_poses[0].T_from_to.p.x() = 1e6; });
}

}  // namespace
}  // namespace fleetloc
