// Keys of a member of a fleet, as they are read: which ones are refused, and in what words.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/transport/fleet_folder.hpp"

namespace fleetloc {
namespace {

using testing::HasSubstr;

class FleetKeysTest : public testing::Test {
 protected:
  FleetKeysTest() { load_secure_profiles(); }

  [[nodiscard]] std::string loading() const {
    return refusal([&] { FleetKeys{folder_}; });
  }

  const FleetFolder fleet_{"campus"};
  const std::filesystem::path folder_ = fleet_.member("robot", "robot_7");
};

TEST_F(FleetKeysTest, NameTheFileThatIsMissingOrNone) {
  EXPECT_EQ(loading(), "no error");
  for (const std::string file : {"key.pem",
                                 "certificate.pem",
                                 "ca.pem",
                                 "permissions.smime",
                                 "governance.smime",
                                 "revoked.pem"}) {
    const auto kept = fleet_.path("kept");
    std::filesystem::rename(folder_ / file, kept);
    EXPECT_THAT(loading(), HasSubstr(file + ": no such file")) << file;
    std::filesystem::rename(kept, folder_ / file);
  }
  for (const std::string file : {"certificate.pem", "ca.pem", "revoked.pem", "key.pem"}) {
    const std::string content = content_of(folder_ / file);
    std::ofstream(folder_ / file) << "nothing";
    EXPECT_THAT(loading(), HasSubstr(file + ": is no ")) << file;
    std::ofstream(folder_ / file) << content;
  }
  EXPECT_EQ(loading(), "no error");
}

TEST_F(FleetKeysTest, AreRefusedIfOthersCanReadThem) {
  using std::filesystem::perms;
  for (const perms open : {perms::group_read, perms::others_read, perms::others_write}) {
    std::filesystem::permissions(folder_ / "key.pem", perms::owner_read | open);
    EXPECT_THAT(loading(), HasSubstr("key.pem: others can read this key"));
  }
  std::filesystem::permissions(folder_ / "key.pem", perms::owner_read | perms::owner_write);
  EXPECT_EQ(loading(), "no error");
}

TEST_F(FleetKeysTest, AreRefusedIfTheyDoNotBelongTogether) {
  std::filesystem::copy_file(fleet_.member("robot", "robot_8") / "key.pem",
                             folder_ / "key.pem",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(loading(), HasSubstr("key.pem: is not the key of certificate.pem"));
  const FleetFolder other("campus");
  std::filesystem::copy_file(other.member("robot", "robot_7") / "ca.pem",
                             fleet_.member("robot", "robot_8") / "ca.pem",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(refusal([&] { static_cast<void>(fleet_.keys("robot", "robot_8")); }),
              HasSubstr("certificate.pem: is not signed by ca.pem"));
}

TEST_F(FleetKeysTest, AreRefusedOnceTheyHaveEnded) {
  const auto ca = fleet_.ca().string();
  const auto certificate = folder_ / "certificate.pem";
  const auto request = fleet_.path("request").string();
  Outcome made = run("/usr/bin/openssl",
                     {"req",
                      "-new",
                      "-key",
                      (folder_ / "key.pem").string(),
                      "-subj",
                      "/O=campus/OU=robot/CN=robot_7",
                      "-out",
                      request});
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  made = run("/usr/bin/openssl",
             {"ca",
              "-config",
              ca + "/openssl.cnf",
              "-batch",
              "-notext",
              "-rand_serial",
              "-startdate",
              "20200101000000Z",
              "-enddate",
              "20200102000000Z",
              "-in",
              request,
              "-out",
              certificate.string()});
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  EXPECT_THAT(loading(), HasSubstr("certificate.pem: has ended"));
}

TEST_F(FleetKeysTest, AreForTheirOwnMemberOnly) {
  TestDomain domain;
  const FleetKeys keys(folder_);
  EXPECT_THAT(
      refusal([&] {
        DdsChannel(secure_on_loopback(domain.number(), ChannelRole::kRobot, "robot_8", keys));
      }),
      HasSubstr("certificate.pem: is of robot 'robot_7', not of robot 'robot_8'"));
  EXPECT_THAT(
      refusal([&] {
        DdsChannel(secure_on_loopback(domain.number(), ChannelRole::kCloud, "robot_7", keys));
      }),
      HasSubstr("not of localizer 'robot_7'"));
}

TEST_F(FleetKeysTest, NeedAProfileForThemWhichNeedsKeys) {
  TestDomain domain;
  EXPECT_THAT(refusal([&] { Participant(domain.number(), "secure_loopback"); }),
              HasSubstr("--security FOLDER"));
  EXPECT_THAT(refusal([&] {
                Participant(domain.number(), "loopback", nullptr, {.keys = FleetKeys(folder_)});
              }),
              HasSubstr("take a -secure file"));
}

}  // namespace
}  // namespace fleetloc
