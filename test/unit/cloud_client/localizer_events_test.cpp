#include "robot/cloud_client/localizer_events.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

LocalizerSelector::Config config() {
  return read_localizer_selector_config(
      ConfigReader::from_string(default_config("robot")).section("client").section("selector"));
}

class LocalizerEventsTest : public testing::Test {
 protected:
  void decide(const LocalizerStatus& status, double s) {
    static_cast<void>(selector_.update(status, at(s)));
    selector_.decide(at(s), {});
  }

  LocalizerSelector selector_{"robot", config()};
  LocalizerEvents events_;
};

TEST_F(LocalizerEventsTest, TellWhichLocalizerIsChosen) {
  decide({.localizer = "a", .incarnation = Incarnation{5}, .accepting = true}, 0);
  events_.chosen(selector_);
  EXPECT_THAT(events_.take(), ElementsAre("localizer a, started as 5: available"));
  EXPECT_THAT(events_.take(), IsEmpty());
}

TEST_F(LocalizerEventsTest, TellOfAnotherMapOnceUntilALocalizerIsChosen) {
  selector_.require_map({1});
  const LocalizerStatus other{
      .localizer = "b", .incarnation = Incarnation{1}, .map_hash = {2}, .accepting = true};
  for (int s = 0; s < 5; ++s) {
    decide(other, s);
    events_.unchanged(selector_);
  }
  EXPECT_THAT(events_.take(), ElementsAre(HasSubstr("localizer b is refused")));
  events_.chosen(selector_);
  events_.left("a", selector_);
  EXPECT_THAT(events_.take(),
              ElementsAre(HasSubstr("started"), HasSubstr("a is left"), HasSubstr("b is refused")));
}

TEST_F(LocalizerEventsTest, TellOfAWarningAndOfItsEndOnce) {
  LocalizerStatus status{
      .localizer = "a", .incarnation = Incarnation{1}, .accepting = true, .draining = false};
  decide(status, 0);
  status.draining = true;
  for (int s = 1; s < 4; ++s) {
    decide(status, s);
    events_.unchanged(selector_);
  }
  EXPECT_THAT(events_.take(), ElementsAre("localizer a is about to end, and there is no other"));
  selector_.answered(at(4));
  events_.unchanged(selector_);
  events_.unchanged(selector_);
  EXPECT_THAT(events_.take(), ElementsAre("localizer a is fine again"));
}

TEST_F(LocalizerEventsTest, TellOfAConflictOnce) {
  for (int i = 0; i < 5; ++i) events_.conflict("a");
  EXPECT_THAT(events_.take(), ElementsAre(HasSubstr("two localizers are named a")));
}

TEST_F(LocalizerEventsTest, TellOfADuplicateIdAfterThreeAnswersThatAreNoLateOnes) {
  events_.start_session(at(100));
  for (int i = 0; i < 50; ++i) events_.foreign_answer(at(129));
  EXPECT_THAT(events_.take(), IsEmpty()) << "to an earlier session of this robot";
  for (int i = 0; i < 2; ++i) events_.foreign_answer(at(131));
  EXPECT_THAT(events_.take(), IsEmpty());
  for (int i = 0; i < 50; ++i) events_.foreign_answer(at(131));
  EXPECT_THAT(events_.take(), ElementsAre(HasSubstr("another robot seems to have this id")));
}

TEST_F(LocalizerEventsTest, AreNotKeptWithoutEnd) {
  for (int i = 0; i < 1000; ++i) events_.stays("a");
  EXPECT_THAT(events_.take(), SizeIs(100));
}

}  // namespace
}  // namespace fleetloc
