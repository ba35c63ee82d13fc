#include "robot/live/image_pairing.hpp"

#include <gmock/gmock.h>

#include "test/unit/live/live_sensors.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ImagePairingTest : public testing::Test {
 protected:
  bool add(Side side, Duration stamp, Duration arrival) {
    const auto number = static_cast<std::uint32_t>(stamp / 1ms);
    return pairing_.add(side, {at(stamp), image(number), arriving(arrival), {}});
  }
  /// "100+103", "100+-", "-+103": stamps of left and right image [ms].
  std::vector<std::string> taken(Duration now) {
    std::vector<std::string> texts;
    for (const StereoFrame& frame : pairing_.take(arriving(now))) {
      const auto text = [](const cv::Mat& gray) {
        return gray.empty() ? "-" : std::to_string(number_of(gray));
      };
      texts.push_back(text(frame.left) + "+" + text(frame.right));
    }
    return texts;
  }

  ImagePairing pairing_{4ms, 50ms};
};

TEST_F(ImagePairingTest, PairsImagesThreeMillisecondsApart) {
  add(Side::kLeft, 100ms, 0ms);
  EXPECT_THAT(taken(1ms), IsEmpty());
  add(Side::kRight, 103ms, 10ms);
  EXPECT_THAT(taken(10ms), ElementsAre("100+103"));
  add(Side::kRight, 197ms, 100ms);
  add(Side::kLeft, 200ms, 101ms);
  EXPECT_THAT(taken(101ms), ElementsAre("200+197"));
  EXPECT_EQ(pairing_.waiting(), 0U);
}

TEST_F(ImagePairingTest, PrefersTheNearestToTheFirst) {
  add(Side::kLeft, 100ms, 0ms);
  add(Side::kLeft, 104ms, 0ms);
  add(Side::kRight, 103ms, 0ms);
  EXPECT_THAT(taken(0ms), ElementsAre("100+-", "104+103"));
  add(Side::kRight, 200ms, 0ms);
  add(Side::kRight, 203ms, 0ms);
  add(Side::kLeft, 202ms, 0ms);
  EXPECT_THAT(taken(0ms), ElementsAre("-+200", "202+203"));
}

TEST_F(ImagePairingTest, WaitsForALatePartnerButNotForever) {
  add(Side::kLeft, 100ms, 0ms);
  EXPECT_THAT(taken(49ms), IsEmpty());
  EXPECT_THAT(taken(50ms), ElementsAre("100+-"));
  EXPECT_FALSE(add(Side::kRight, 101ms, 60ms));  // its frame has gone
  EXPECT_TRUE(add(Side::kRight, 200ms, 100ms));
  EXPECT_THAT(taken(150ms), ElementsAre("-+200"));
}

TEST_F(ImagePairingTest, DoesNotWaitForAPartnerThatWasOvertaken) {
  add(Side::kLeft, 100ms, 0ms);
  add(Side::kLeft, 130ms, 30ms);
  add(Side::kRight, 130ms, 31ms);
  EXPECT_THAT(taken(31ms), ElementsAre("100+-", "130+130"));
}

TEST_F(ImagePairingTest, HoldsTheNewestOnesIfNobodyTakesThem) {
  for (int i = 0; i < 1000; ++i) add(Side::kLeft, i * 10ms, 0ms);
  EXPECT_EQ(pairing_.waiting(), 16U);
  EXPECT_EQ(pairing_.dropped(), 984U);
  EXPECT_EQ(taken(1s).back(), "9990+-");
}

}  // namespace
}  // namespace fleetloc
