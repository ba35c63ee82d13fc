#include "deploy/replay/align_once.hpp"

#include <gmock/gmock.h>

#include "test/truthful_localizer.hpp"

namespace fleetloc {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class AlignOnceTest : public testing::Test {
 protected:
  AlignOnceTest() { once_.start_session({}, {}); }

  void submit(int count) {
    Submap submap;
    submap.keyframes.resize(1);
    for (int i = 0; i < count; ++i) once_.submit(submap, {});
  }

  TruthfulLocalizer localizer_{[](Timestamp) { return Pose{}; }};
  AlignOnce once_{localizer_};
};

TEST_F(AlignOnceTest, GivesAnswersOneByOneUntilOneIsApplied) {
  submit(3);
  EXPECT_THAT(once_.take_answers({}), SizeIs(1));
  EXPECT_THAT(once_.take_answers({}), SizeIs(1));
  once_.note_applied();
  EXPECT_EQ(localizer_.applied, 1);
  EXPECT_THAT(once_.take_answers({}), IsEmpty());
  submit(2);
  EXPECT_THAT(once_.take_answers({}), IsEmpty());
  EXPECT_THAT(once_.take_answers({}), IsEmpty());
}

TEST_F(AlignOnceTest, GivesNoCorrectionEver) {
  localizer_.correction.emplace();
  EXPECT_FALSE(once_.take_correction().has_value());
  EXPECT_FALSE(localizer_.correction.has_value());  // it is not kept for later
}

}  // namespace
}  // namespace fleetloc
