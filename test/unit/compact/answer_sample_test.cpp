#include "shared/compact/answer_sample.hpp"

#include <limits>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <idl/localizationPubSubTypes.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kDatagram = 1200;

Answer answer_round_trip(const Answer& sent) {
  return decode_answer(encode(sent, kDatagram)).value();
}

void expect_answer_refused(Malformed reason,
                           const std::function<void(wire::LocalizationResult&)>& corrupt) {
  auto sample =
      from_cdr<wire::LocalizationResult>(encode(Answer{some_answer(), {}}, kDatagram), 2).value();
  corrupt(sample);
  const auto decoded = decode_answer(to_cdr(sample));
  ASSERT_FALSE(decoded.has_value()) << "expected " << name(reason);
  EXPECT_EQ(name(decoded.error()), name(reason));
}

TEST(AnswerSample, RoundTripPreservesEveryField) {
  const Answer sent{some_answer(), some_correction()};
  const Answer received = answer_round_trip(sent);
  const LocalizationResult& a = received.result;
  const LocalizationResult& b = sent.result;
  EXPECT_EQ(a.robot, b.robot);
  EXPECT_EQ(a.session, b.session);
  EXPECT_EQ(a.localizer, b.localizer);
  EXPECT_EQ(a.incarnation, b.incarnation);
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.acknowledgements.base, b.acknowledgements.base);
  EXPECT_EQ(a.acknowledgements.bitmap, b.acknowledgements.bitmap);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.keyframe, b.keyframe);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_LE(std::chrono::abs(a.oldest_stamp - b.oldest_stamp), std::chrono::microseconds(500));
  EXPECT_EQ(a.map_hash, b.map_hash);
  EXPECT_EQ(a.holding_time, std::chrono::milliseconds(12));
  expect_near(a.T_map_body, b.T_map_body, 4e-9, 0.0);
  expect_near(a.covariance, b.covariance, 0.05);
  ASSERT_TRUE(received.correction);
  EXPECT_EQ(received.correction->robot, b.robot);
  EXPECT_EQ(received.correction->session, b.session);
  EXPECT_EQ(received.correction->anchor, b.keyframe);
  EXPECT_EQ(received.correction->landmarks.size(), sent.correction->landmarks.size());
}

TEST(AnswerSample, RoundTripPreservesEveryStatus) {
  for (int status = 0; status <= static_cast<int>(LocalizationStatus::kAmbiguous); ++status) {
    Answer sent{some_answer(), {}};
    sent.result.status = static_cast<LocalizationStatus>(status);
    EXPECT_EQ(answer_round_trip(sent).result.status, sent.result.status);
  }
}

TEST(AnswerSample, ARejectionHasNoPose) {
  Answer sent{some_answer(), {}};
  sent.result.status = LocalizationStatus::kPoorFit;
  sent.result.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const LocalizationResult received = answer_round_trip(sent).result;
  EXPECT_TRUE(received.T_map_body.p.isZero());
  EXPECT_TRUE(received.covariance.isZero());
  EXPECT_EQ(received.oldest_stamp, received.stamp);
}

TEST(AnswerSample, TellsOfPlacesWhereThereIsNoPose) {
  Answer sent{some_answer(), {}};
  sent.result.places = 12;
  EXPECT_EQ(answer_round_trip(sent).result.places, 0);
  sent.result.status = LocalizationStatus::kAmbiguous;
  EXPECT_EQ(answer_round_trip(sent).result.places, 12);
  sent.result.places = 1000;
  EXPECT_EQ(answer_round_trip(sent).result.places, 255);
}

TEST(AnswerSample, ManyCorrectionsAreCutToTheMostInformative) {
  const Answer sent{some_answer(), some_correction(100)};
  for (const std::size_t limit : {480U, 700U, 1200U}) {
    const Bytes bytes = encode(sent, limit);
    EXPECT_LE(bytes.size(), limit);
    EXPECT_GT(bytes.size(), limit - 100);
    const auto correction = decode_answer(bytes).value().correction.value();
    EXPECT_GE(correction.landmarks.size(), 10U);
    if (limit > 480) {
      EXPECT_EQ(correction.relative_poses.size(), 7U);
    }
    double least = 1e300;
    for (const auto& landmark : correction.landmarks) {
      least = std::min(least, landmark.information.trace());
    }
    int more = 0;
    for (const auto& landmark : sent.correction->landmarks) {
      more += landmark.information.trace() > 1.2 * least ? 1 : 0;
    }
    EXPECT_LE(more, static_cast<int>(correction.landmarks.size()));
  }
}

TEST(AnswerSample, WithoutRoomThereAreNoCorrections) {
  const std::size_t without = encode(Answer{some_answer(), {}}, 1200).size();
  const Bytes bytes = encode(Answer{some_answer(), some_correction()}, without + 8);
  EXPECT_FALSE(decode_answer(bytes).value().correction);
  EXPECT_EQ(bytes.size(), without);
}

TEST(AnswerSample, RefusesWithAReason) {
  using enum Malformed;
  expect_answer_refused(kInvalidId, [](auto& sample) { sample.robot("?"); });
  expect_answer_refused(kInvalidId, [](auto& sample) { sample.localizer(""); });
  expect_answer_refused(kOutOfRange, [](auto& sample) { sample.holding_time_ms(4'000'000); });
  expect_answer_refused(kNotFinite, [](auto& sample) {
    sample.p_map()[0] = std::numeric_limits<double>::infinity();
  });
  expect_answer_refused(kNotARotation, [](auto& sample) { sample.rotation({1, 2, 3, 4}); });
  expect_answer_refused(kOutOfRange, [](auto& sample) { sample.information_root()[3] = 0; });
  expect_answer_refused(kUndecodable, [](auto& sample) { sample.corrections({1, 2, 3}); });
}

// As of a robot that was parked meanwhile.
TEST(AnswerSample, AWindowOfHoursIsToldAsAnHour) {
  Answer sent{some_answer(), {}};
  sent.result.oldest_stamp = sent.result.stamp - std::chrono::hours(30);
  const LocalizationResult received = answer_round_trip(sent).result;
  EXPECT_EQ(received.stamp - received.oldest_stamp, std::chrono::hours(1));
}

// Loose along one direction, as along a corridor: told with an error of a fraction, and never as
// more certain than it is.
TEST(AnswerSample, ACovarianceThatIsLooseAlongOneDirectionIsTold) {
  for (const double loose_m : {0.1, 0.35, 0.65, 1.0, 2.0, 10.0}) {
    for (int i = 0; i < 50; ++i) {
      const Pose T = some_pose(0.37 * i);
      const Matrix6d A = adjoint({T.R, 0.1 * T.p});
      Vector6d sigmas;
      sigmas << 0.0012, 0.0012, 0.0012, 0.0105, 0.0105, loose_m;
      Answer sent{some_answer(), {}};
      sent.result.covariance = A * sigmas.cwiseAbs2().asDiagonal() * A.transpose();
      const Matrix6d received = answer_round_trip(sent).result.covariance;
      const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> ratio(received,
                                                                     sent.result.covariance);
      EXPECT_GE(ratio.eigenvalues().minCoeff(), 0.8) << loose_m;
      EXPECT_LE(std::sqrt(received.bottomRightCorner<3, 3>().trace()), 1.3 * loose_m) << loose_m;
    }
  }
}

TEST(AnswerSample, RefusesToEncodeAnImpossibleOne) {
  Answer sent{some_answer(), {}};
  sent.result.oldest_stamp = sent.result.stamp + std::chrono::seconds(1);
  EXPECT_THROW(encode(sent, kDatagram), NotEncodable);
  sent = {some_answer(), {}};
  sent.result.covariance.setZero();
  EXPECT_THROW(encode(sent, kDatagram), NotEncodable);
}

}  // namespace
}  // namespace fleetloc
