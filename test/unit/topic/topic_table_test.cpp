#include "deploy/topic/topic_table.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

const std::vector<ObservedTopic> kTopics{
    {.name = "fleetloc/2/localizers", .type = "LocalizerStatus", .writers = 1, .readers = 2},
    {.name = "other", .type = "Other", .writers = 0, .readers = 1}};

TEST(TopicTable, HasALineForEachTopicWithWhatWasHeardOfIt) {
  EXPECT_EQ(topic_table(kTopics, {{"fleetloc/2/localizers", {.samples = 5, .bytes = 600}}}, 10.0),
            "topic                  type             writers  readers  samples/s  bytes/s\n"
            "fleetloc/2/localizers  LocalizerStatus  1        2        0.5        60.0\n"
            "other                  Other            0        1        -          -\n");
}

TEST(TopicTable, HasNoRatesIfNobodyListened) {
  EXPECT_EQ(topic_table(kTopics, {}, std::nullopt),
            "topic                  type             writers  readers  samples/s  bytes/s\n"
            "fleetloc/2/localizers  LocalizerStatus  1        2        -          -\n"
            "other                  Other            0        1        -          -\n");
}

TEST(TopicTable, AUserMayWriteTheEndOfAName) {
  const std::string topic = "fleetloc/2/robot_1/localization";
  EXPECT_TRUE(is_meant("", topic));
  EXPECT_TRUE(is_meant(topic, topic));
  EXPECT_TRUE(is_meant("localization", topic));
  EXPECT_TRUE(is_meant("robot_1/localization", topic));
  EXPECT_FALSE(is_meant("1/localization", topic));
  EXPECT_FALSE(is_meant("robot_1", topic));
}

}  // namespace
}  // namespace fleetloc
