#include "shared/link/link_config.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/test_folder.hpp"
#include "test/unit/config/config_error.hpp"

namespace fleetloc {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kPlain = "loss: 0, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0";
const std::string kLimited = "loss: 0, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 1500";

LinkConfig read(const std::string& uplink) {
  return read_link_config(
      ConfigReader::from_string(
          "seed: 5\nuplink: {" + uplink +
          "}\ndownlink: {loss: 0, delay_s: 0.5, rate_bytes_per_s: 0, queue_bytes: 0}\n"),
      test_folder());
}

void expect_refused(const std::string& uplink, const std::string& key, const std::string& reason) {
  EXPECT_THAT(config_error([&] { read(uplink); }),
              AllOf(HasSubstr(":2: uplink" + key), HasSubstr(reason)))
      << uplink;
}

std::string trace_file(const std::string& content) {
  std::ofstream(test_folder() / "trace.csv") << content;
  return kLimited + ", rate_trace_file: trace.csv";
}

TEST(LinkConfig, NeedsNoMoreThanItAlwaysDid) {
  const LinkConfig link =
      read("loss: 0.3, delay_s: 1.5, rate_bytes_per_s: 31250, queue_bytes: 65536");
  EXPECT_EQ(link.seed, 5);
  EXPECT_EQ(link.uplink.loss, 0.3);
  EXPECT_EQ(link.uplink.delay_s, 1.5);
  EXPECT_EQ(link.uplink.rate_bytes_per_s, 31250.0);
  EXPECT_EQ(link.uplink.queue_bytes, 65536);
  EXPECT_EQ(link.downlink.delay_s, 0.5);
  EXPECT_EQ(link.uplink.burst_length, 1.0);
  EXPECT_EQ(link.uplink.jitter_s, 0.0);
  EXPECT_EQ(link.uplink.reordering, 0.0);
  EXPECT_EQ(link.uplink.duplication, 0.0);
  EXPECT_TRUE(link.uplink.rate_trace.steps.empty());
  EXPECT_TRUE(link.uplink.outages.at.empty());
  EXPECT_EQ(link.uplink.outages.periodic.every_s, 0.0);
}

TEST(LinkConfig, MayNameEverythingElse) {
  const LinkDirection uplink =
      read(kLimited +
           ", burst_length: 3, jitter_s: 0.1, reordering: 0.01, reordering_delay_s: 0.2,"
           " duplication: 0.02, rate_trace: [[0, 4000], [2.5, 0]], rate_trace_repeat_s: 5,"
           " outages: [[30, 10], [60, 1.5]],"
           " periodic_outage: {every_s: 100, from_s: 20, for_s: 3}")
          .uplink;
  EXPECT_EQ(uplink.burst_length, 3.0);
  EXPECT_EQ(uplink.jitter_s, 0.1);
  EXPECT_EQ(uplink.reordering, 0.01);
  EXPECT_EQ(uplink.reordering_delay_s, 0.2);
  EXPECT_EQ(uplink.duplication, 0.02);
  ASSERT_EQ(uplink.rate_trace.steps.size(), 2);
  EXPECT_EQ(uplink.rate_trace.steps[1].time_s, 2.5);
  EXPECT_EQ(uplink.rate_trace.steps[0].bytes_per_s, 4000.0);
  EXPECT_EQ(uplink.rate_trace.repeat_s, 5.0);
  ASSERT_EQ(uplink.outages.at.size(), 2);
  EXPECT_EQ(uplink.outages.at[1].from_s, 60.0);
  EXPECT_EQ(uplink.outages.at[1].for_s, 1.5);
  EXPECT_EQ(uplink.outages.periodic.every_s, 100.0);
  EXPECT_EQ(uplink.outages.periodic.from_s, 20.0);
  EXPECT_EQ(uplink.outages.periodic.for_s, 3.0);
}

TEST(LinkConfig, ReadsATraceFromAFileBesideIt) {
  const RateTrace trace =
      read(trace_file("# time_s, bytes_per_s\n0, 4000\n10, 2000\n")).uplink.rate_trace;
  ASSERT_EQ(trace.steps.size(), 2);
  EXPECT_EQ(trace.steps[1].time_s, 10.0);
  EXPECT_EQ(trace.steps[1].bytes_per_s, 2000.0);
  EXPECT_EQ(trace.repeat_s, 0.0);
}

TEST(LinkConfig, IsTheSameAfterBeingWritten) {
  LinkConfig link =
      read(kLimited +
           ", burst_length: 3, jitter_s: 0.1, reordering: 0.01,"
           " reordering_delay_s: 0.2, duplication: 0.02,"
           " rate_trace: [[0, 4000], [2.5, 0]], rate_trace_repeat_s: 5,"
           " outages: [[30, 10]], periodic_outage: {every_s: 9, from_s: 2, for_s: 3}");
  const std::string yaml = link_yaml(link);
  EXPECT_EQ(link_yaml(read_link_config(ConfigReader::from_string(yaml))), yaml);
  for (const char* key : {"burst_length: 3",
                          "jitter_s: 0.1",
                          "reordering: 0.01",
                          "reordering_delay_s: 0.2",
                          "duplication: 0.02",
                          "rate_trace: [[0, 4000], [2.5, 0]]",
                          "rate_trace_repeat_s: 5",
                          "outages: [[30, 10]]",
                          "periodic_outage: {every_s: 9, from_s: 2, for_s: 3}"}) {
    EXPECT_THAT(yaml, HasSubstr(key));
  }
}

TEST(LinkConfig, WritesWhatIsSaidOnly) {
  EXPECT_EQ(link_yaml({.uplink = {.loss = 0.5}, .downlink = {}, .seed = 3}),
            "seed: 3\n"
            "uplink: {loss: 0.5, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0}\n"
            "downlink: {loss: 0, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0}\n");
}

TEST(LinkConfig, NamesWhatIsWrong) {
  expect_refused(
      "loss: 1.1, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0", ".loss", "must be in 0..1");
  expect_refused(
      "loss: .nan, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0", ".loss", "must be in");
  expect_refused("loss: 0, delay_s: 0, rate_bytes_per_s: 1000, queue_bytes: 0",
                 ".queue_bytes",
                 "must be in 1500..");
  expect_refused("loss: 0, delay_s: 0, rate_bytes_per_s: 0.5, queue_bytes: 9000",
                 ".rate_bytes_per_s",
                 "must be 0 (unlimited) or at least 1");
  expect_refused("loss: 0, delay_s: 0, queue_bytes: 0", ".rate_bytes_per_s", "missing");
  expect_refused(kPlain + ", jiter_s: 1", ".jiter_s", "unknown key");
  expect_refused(kPlain + ", burst_length: 0.5", ".burst_length", "must be in 1..");
  expect_refused(kPlain + ", jitter_s: -1", ".jitter_s", "must be in 0..");
  expect_refused(kPlain + ", reordering: 0.1", ".reordering", "needs a reordering_delay_s above 0");
  expect_refused(kPlain + ", duplication: 2", ".duplication", "must be in 0..1");
}

TEST(LinkConfig, NamesWhatIsWrongWithATrace) {
  const auto refuse = [](const std::string& trace, const std::string& reason) {
    expect_refused(kLimited + ", rate_trace: " + trace, ".rate_trace", reason);
  };
  refuse("[]", "is empty");
  refuse("[[1, 4000]]", "must begin at 0 s");
  refuse("[[0, 4000], [0, 2000]]", "times must ascend");
  refuse("[[0, 0.5]]", "rates must be 0 (nothing passes) or 1..");
  refuse("[[0, 4000], [.nan, 4000]]", "times 0..1e9 s");
  refuse("[[0, 4000], [5, 0]]", "must not end with a rate of 0");
  refuse("[[0, 0], [5, 0]], rate_trace_repeat_s: 10", "has no rate above 0");
  refuse("[[0, 4000], [5, 1000]], rate_trace_repeat_s: 5", "behind the last step");
  refuse("[[0, 4000]], rate_trace_file: trace.csv", "stands beside rate_trace");
  refuse("[0, 4000]", "bad conversion");
  expect_refused(kLimited + ", rate_trace_repeat_s: 5", ".rate_trace_repeat_s", "needs a trace");
  expect_refused(kPlain + ", rate_trace: [[0, 4000]]", ".queue_bytes", "must be in 1500..");
}

TEST(LinkConfig, NamesFileAndLineOfAWrongTraceFile) {
  expect_refused(trace_file("0, 4000\n5\n"), ".rate_trace_file", "trace.csv:2: ");
  expect_refused(trace_file("0, fast\n"), ".rate_trace_file", "trace.csv:1: 'fast'");
  expect_refused(trace_file("0, 4000\n5, 0\n"), ".rate_trace_file", "must not end with");
  expect_refused(kLimited + ", rate_trace_file: none.csv", ".rate_trace_file", "none.csv");
}

TEST(LinkConfig, NamesWhatIsWrongWithOutages) {
  expect_refused(kPlain + ", outages: [[-1, 5]]", ".outages", "times must be in 0..1e9 s");
  expect_refused(kPlain + ", outages: [[1, 5, 6]]", ".outages", "bad conversion");
  const auto refuse = [](const std::string& values, const std::string& key) {
    expect_refused(kPlain + ", periodic_outage: {" + values + "}", ".periodic_outage." + key, "");
  };
  refuse("every_s: 0, from_s: 0, for_s: 0", "every_s: must be in");
  refuse("every_s: 10, from_s: 0, for_s: 11", "for_s: must be in 0..10");
  refuse("every_s: 10, from_s: 0", "for_s: missing");
  refuse("every_s: 10, from_s: 0, for_s: 1, until_s: 9", "until_s: unknown key");
}

}  // namespace
}  // namespace fleetloc
