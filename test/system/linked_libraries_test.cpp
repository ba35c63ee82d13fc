// What the programs need on a machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/child_program.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Robot, LinksNoPointCloudLibrary) {
  const Outcome linked = run("/usr/bin/ldd", {FLEETLOC_ROBOT});
  ASSERT_EQ(linked.exit_code, 0) << linked.errors;
  EXPECT_THAT(linked.output, HasSubstr("libfastrtps"));
  EXPECT_THAT(linked.output, AllOf(Not(HasSubstr("libpcl")), Not(HasSubstr("libvtk"))));
}

}  // namespace
}  // namespace fleetloc
