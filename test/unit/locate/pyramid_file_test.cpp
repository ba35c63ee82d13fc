#include "cloud/locate/pyramid_file.hpp"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud/locate/pyramid_config.hpp"
#include "test/test_folder.hpp"
#include "test/unit/locate/street_map.hpp"

namespace fleetloc {
namespace {

using std::filesystem::path;
using testing::HasSubstr;

constexpr MapHash kHash{1, 2, 3};

class PyramidFile : public testing::Test {
 protected:
  PyramidFile() { save_pyramid(pyramid_, pyramid_config(), kHash, file_); }

  [[nodiscard]] std::string content() const {
    std::ifstream stream(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void replace_by(const std::string& content) const {
    std::ofstream(file_, std::ios::binary) << content;
  }
  [[nodiscard]] std::string reason(const MapHash& map = kHash,
                                   MapPyramid::Config config = pyramid_config()) const {
    const auto loaded = load_pyramid(file_, map, config);
    return loaded ? "" : loaded.error();
  }

  const LaserMap map_ = StreetMap(3).map();
  const MapPyramid pyramid_{map_, pyramid_config()};
  const path file_ = test_folder() / "map.pyramid";
};

TEST_F(PyramidFile, GivesThePyramidThatWasMade) {
  const auto loaded = load_pyramid(file_, kHash, pyramid_config());
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(loaded->min(), pyramid_.min());
  EXPECT_EQ(loaded->max(), pyramid_.max());
  EXPECT_EQ(loaded->bytes(), pyramid_.bytes());
  EXPECT_EQ(loaded->ground().heights(), pyramid_.ground().heights());
  EXPECT_EQ(loaded->ground().at(12.0, 7.0), pyramid_.ground().at(12.0, 7.0));
  for (int z = pyramid_.min().z() - 1; z <= pyramid_.max().z(); ++z) {
    for (int y = pyramid_.min().y() - 1; y <= pyramid_.max().y(); ++y) {
      for (int x = pyramid_.min().x() - 1; x <= pyramid_.max().x(); ++x) {
        ASSERT_EQ(loaded->value(x, y, z), pyramid_.value(x, y, z));
      }
    }
  }
  for (int level = 0; level < pyramid_.levels(); ++level) {
    for (int slab = 0; slab <= pyramid_.any_height(); ++slab) {
      for (int y = pyramid_.min().y() - 9; y <= pyramid_.max().y(); y += 2) {
        for (int x = pyramid_.min().x() - 9; x <= pyramid_.max().x(); x += 2) {
          ASSERT_EQ(loaded->windows(level, slab).largest(x, y),
                    pyramid_.windows(level, slab).largest(x, y));
        }
      }
    }
  }
}

TEST_F(PyramidFile, LiesBesideItsMapAndLeavesNothingElseThere) {
  EXPECT_EQ(pyramid_file("maps/hall.pcd"), path("maps/hall.pyramid"));
  EXPECT_FALSE(std::filesystem::exists(file_.string() + ".new"));
}

TEST_F(PyramidFile, IsOfOneMapAndConfiguration) {
  EXPECT_THAT(reason(MapHash{1, 2, 4}), HasSubstr("another map"));
  MapPyramid::Config config = pyramid_config();
  config.cell_m *= 2.0;
  EXPECT_THAT(reason(kHash, config), HasSubstr("other cells"));
  config = pyramid_config();
  config.level_from = 0.5;
  EXPECT_THAT(reason(kHash, config), HasSubstr("other cells"));
}

TEST_F(PyramidFile, MayHaveAnotherNumberOfLevelsThanIsAskedFor) {
  MapPyramid::Config config = pyramid_config();
  config.levels += 1;
  const auto loaded = load_pyramid(file_, kHash, config);
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(loaded->levels(), config.levels);
}

TEST_F(PyramidFile, IsOfNoUseIfItIsMissingCutOrChanged) {
  const std::string whole = content();
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 97) {
    replace_by(whole.substr(0, size));
    EXPECT_NE(reason(), "") << size;
  }
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 211) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    replace_by(changed);
    EXPECT_NE(reason(), "") << at;
  }
  replace_by(whole + "x");
  EXPECT_EQ(reason(), "is damaged");
  std::filesystem::remove(file_);
  EXPECT_EQ(reason(), "is not there, or cannot be read");
  std::filesystem::create_directory(file_);
  EXPECT_EQ(reason(), "is not there, or cannot be read");
  std::filesystem::remove(file_);
}

TEST_F(PyramidFile, ThatCannotBeWrittenIsNamed) {
  const path file = test_folder() / "no_folder" / "map.pyramid";
  try {
    save_pyramid(pyramid_, pyramid_config(), kHash, file);
    FAIL() << "no error";
  } catch (const PyramidFileError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.string()));
  }
}

TEST(PreparedPyramid, IsTheStoredOneOrSaysWhyItWasMade) {
  const LaserMap map = StreetMap(3).map();
  const PyramidConfig config{
      .min_cell_m = 0.5, .max_cell_m = 0.5, .cells = 100, .levels = 4, .level_from = 0.9};
  const path pcd_file = test_folder() / "streets.pcd";
  const PreparedPyramid made = prepare_pyramid(map, pcd_file, config);
  EXPECT_EQ(made.why_made, "is not there, or cannot be read");
  const MapPyramid::Config cells = pyramid_cells(map.info(), config);
  save_pyramid(*made.pyramid, cells, map.info().hash, pyramid_file(pcd_file));
  const PreparedPyramid stored = prepare_pyramid(map, pcd_file, config);
  EXPECT_EQ(stored.why_made, "");
  EXPECT_EQ(stored.pyramid->bytes(), made.pyramid->bytes());
}

}  // namespace
}  // namespace fleetloc
