#include "deploy/evaluation/experiment/fingerprint.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "test/unit/experiment/plan_files.hpp"

namespace fleetloc {
namespace {

TEST(Fingerprint, IsThatOfXxh3) {
  EXPECT_EQ(Fingerprint().text(), "2d06800538d394c2");
}

TEST(Fingerprint, KeepsPartsApart) {
  EXPECT_NE(Fingerprint().add("a", "bc").text(), Fingerprint().add("ab", "c").text());
  EXPECT_NE(Fingerprint().add("a", "").add("b", "").text(), Fingerprint().add("a", "b").text());
}

TEST(Fingerprint, FollowsTheContentOfAFile) {
  write("one", "text");
  const std::string before = Fingerprint().add_file("x", test_folder() / "one").text();
  EXPECT_EQ(Fingerprint().add_file("x", test_folder() / "one").text(), before);
  write("one", "tekst");
  EXPECT_NE(Fingerprint().add_file("x", test_folder() / "one").text(), before);
  EXPECT_THROW(Fingerprint().add_file("x", test_folder() / "none"), std::runtime_error);
}

TEST(Fingerprint, FollowsTheFilesOfAFolder) {
  write("folder/a.csv", "1,2");
  write("folder/b.png", "image");
  const auto text = [] { return Fingerprint().add_folder("x", test_folder() / "folder").text(); };
  const std::string before = text();
  EXPECT_EQ(text(), before);
  write("folder/a.csv", "1,3");
  const std::string other = text();
  EXPECT_NE(other, before);
  write("folder/b.png", "imago");  // also where the size stays
  const std::string third = text();
  EXPECT_NE(third, other);
  write("folder/c.png", "");
  EXPECT_NE(text(), third);
}

}  // namespace
}  // namespace fleetloc
