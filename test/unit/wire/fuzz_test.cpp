#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "shared/wire/pose_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/unit/wire/samples.hpp"

// What an attacker or a bad link could send: nothing may crash, and whatever is accepted is valid.
// Validity is that the encoder, which checks the model's values by itself, takes it again.
namespace fleetloc {
namespace {

constexpr int kTrials = 4'000;

Bytes with_flipped_bytes(Bytes bytes, std::mt19937& random) {
  const int flips = 1 + static_cast<int>(random() % 8);
  for (int i = 0; i < flips; ++i) {
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
  }
  return bytes;
}

/// An aligned word becomes an extreme one, which reaches counts and numbers more often.
Bytes with_extreme_word(Bytes bytes, std::mt19937& random) {
  constexpr std::array<std::uint32_t, 8> kWords{
      0, 1, 0x7FFF'FFFF, 0x8000'0000, 0xFFFF'FFFF, 0x7FC0'0000, 0x7F80'0000, 0x7FF0'0000};
  const std::size_t at = 4 * (random() % (bytes.size() / 4));
  const std::uint32_t word = kWords[random() % kWords.size()];
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(word >> (8 * i));
  return bytes;
}

Bytes truncated(Bytes bytes, std::mt19937& random) {
  bytes.resize(random() % bytes.size());
  return bytes;
}

Bytes random_bytes(const Bytes& like, std::mt19937& random) {
  Bytes bytes(random() % like.size());
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  for (std::size_t i = 0; i < std::min<std::size_t>(4, bytes.size()); ++i) bytes[i] = like[i];
  return bytes;
}

/// Returns how many of the changed samples were accepted.
template <typename Decode>
int fuzz(const Bytes& seed, Decode decode) {
  std::mt19937 random(7);
  int accepted = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    for (const auto change : {with_flipped_bytes, with_extreme_word, truncated}) {
      const auto decoded = decode(change(seed, random));
      if (decoded) {
        ++accepted;
        EXPECT_NO_THROW(encode(*decoded));
      }
    }
    EXPECT_FALSE(decode(random_bytes(seed, random)).has_value());
  }
  return accepted;
}

TEST(Fuzz, SubmapsAreRefusedOrValid) {
  EXPECT_GT(fuzz(encode(some_submap(3, 8)), decode_submap), 0);
}

TEST(Fuzz, SessionsAreRefusedOrValid) {
  EXPECT_GT(fuzz(encode(some_session()), decode_robot_session), 0);
}

TEST(Fuzz, LocalizerStatusIsRefusedOrValid) {
  EXPECT_GT(fuzz(encode(some_localizer_status()), decode_localizer_status), 0);
}

TEST(Fuzz, RobotStatusIsRefusedOrValid) {
  EXPECT_GT(fuzz(encode(some_robot_status()), decode_robot_status), 0);
}

TEST(Fuzz, PosesAreRefusedOrValid) {
  EXPECT_GT(fuzz(encode(some_pose_estimate()), decode_pose_estimate), 0);
}

TEST(Fuzz, AcceptedSubmapsHavePositiveSemiDefiniteInformation) {
  std::mt19937 random(11);
  const Bytes seed = encode(some_submap());
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto submap = decode_submap(with_flipped_bytes(seed, random));
    if (!submap) continue;
    for (const VirtualEdge& edge : submap->edges) {
      const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(edge.information, Eigen::EigenvaluesOnly);
      EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-9 * eigen.eigenvalues().maxCoeff());
    }
  }
}

}  // namespace
}  // namespace fleetloc
