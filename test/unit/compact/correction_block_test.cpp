#include "shared/compact/correction_block.hpp"

#include <gtest/gtest.h>

#include "shared/compact/compact_root.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

Correction correction_round_trip(const Correction& sent) {
  return decode_corrections(encode_corrections(sent), sent.anchor).value();
}

// Entries against the root of the diagonal entries of their columns' groups.
template <typename Matrix>
void expect_nearly(const Matrix& a, const Matrix& b) {
  const auto size = [&](Eigen::Index i) {
    return std::sqrt(b.diagonal().segment(3 * (i / 3), 3).maxCoeff());
  };
  for (Eigen::Index i = 0; i < b.rows(); ++i) {
    for (Eigen::Index j = 0; j < b.cols(); ++j) {
      EXPECT_NEAR(a(i, j), b(i, j), 0.15 * size(i) * size(j) + 1e-12) << i << " " << j;
    }
  }
}

TEST(CorrectionBlock, RoundTripPreservesEveryItem) {
  const Correction sent = some_correction();
  const Correction received = correction_round_trip(sent);
  EXPECT_EQ(received.anchor, sent.anchor);
  ASSERT_EQ(received.relative_poses.size(), sent.relative_poses.size());
  for (std::size_t i = 0; i < sent.relative_poses.size(); ++i) {
    EXPECT_EQ(received.relative_poses[i].from, sent.relative_poses[i].from);
    EXPECT_EQ(received.relative_poses[i].to, sent.relative_poses[i].to);
    expect_near(
        received.relative_poses[i].T_from_to, sent.relative_poses[i].T_from_to, 6e-5, 0.26e-3);
    expect_nearly(received.relative_poses[i].information, sent.relative_poses[i].information);
  }
  ASSERT_EQ(received.landmarks.size(), sent.landmarks.size());
  for (std::size_t i = 0; i < sent.landmarks.size(); ++i) {
    EXPECT_EQ(received.landmarks[i].id, sent.landmarks[i].id);
    EXPECT_LE((received.landmarks[i].p_anchor - sent.landmarks[i].p_anchor).cwiseAbs().maxCoeff(),
              1.001e-3);
    expect_nearly(received.landmarks[i].information, sent.landmarks[i].information);
  }
}

// Truncated levels never tell anything along a direction without information.
TEST(CorrectionBlock, TellsLittleAcrossTheNormalOfAPlane) {
  Correction sent = some_correction(1);
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, 2.0, -0.5).normalized();
  sent.landmarks[0].information = 1e4 * normal * normal.transpose();
  const auto received = correction_round_trip(sent).landmarks[0].information;
  const Eigen::Vector3d across = normal.unitOrthogonal();
  EXPECT_LT(across.dot(received * across), 1e4 * 4e-3);
  EXPECT_GT(normal.dot(received * normal), 1e4 * 0.85);
}

// Which the trained models count on.
TEST(CompactRoot, HasNoNegativeDiagonal) {
  for (const Correction::RelativePose& pose : some_correction().relative_poses) {
    const auto root = CompactRoot<6>::of(pose.information);
    auto entry = root.entries.begin();
    for (std::ptrdiff_t row = 0; row < 6; ++row) {
      EXPECT_GE(*entry, CompactRoot<6>::kZero) << row;
      entry += 6 - row;
    }
  }
}

TEST(CorrectionBlock, TwentyLandmarksTakeLessThanHalfADatagram) {
  EXPECT_LT(encode_corrections(some_correction(20)).size(), 500U);
}

TEST(CorrectionBlock, AnEmptyOneIsABlockAsWell) {
  Correction sent;
  sent.anchor = KeyframeId{5};
  const Correction received = correction_round_trip(sent);
  EXPECT_TRUE(received.relative_poses.empty());
  EXPECT_TRUE(received.landmarks.empty());
}

TEST(CorrectionBlock, RefusesToEncodeDisorder) {
  const auto change = [](auto corrupt) {
    Correction correction = some_correction();
    corrupt(correction);
    EXPECT_THROW(encode_corrections(correction), NotEncodable);
  };
  change([](Correction& c) { std::swap(c.landmarks[0], c.landmarks[1]); });
  change([](Correction& c) { c.relative_poses[1].to = c.relative_poses[0].to; });
  change([](Correction& c) { c.relative_poses[0].from = c.relative_poses[0].to; });
  change([](Correction& c) { c.anchor = KeyframeId{99'990}; });
  change([](Correction& c) { c.landmarks[0].p_anchor.x() = 70.0; });
  change([](Correction& c) { c.landmarks[0].information(0, 0) = -1.0; });
}

TEST(CorrectionBlock, RefusesAnotherAnchorThanItsPosesFit) {
  EXPECT_FALSE(decode_corrections(encode_corrections(some_correction()), KeyframeId{3}));
}

}  // namespace
}  // namespace fleetloc
