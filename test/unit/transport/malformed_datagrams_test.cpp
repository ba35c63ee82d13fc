#include "shared/transport/malformed_datagrams.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

TEST(MalformedDatagrams, AreCountedByTheirDefect) {
  MalformedDatagrams malformed;
  EXPECT_THAT(malformed.counts(), IsEmpty());
  malformed.add(RtpsDefect::kVersion);
  malformed.add(RtpsDefect::kStatistics);
  malformed.add(RtpsDefect::kStatistics);
  EXPECT_THAT(malformed.counts(), UnorderedElementsAre(Pair("version", 1), Pair("statistics", 2)));
}

}  // namespace
}  // namespace fleetloc
