#include "deploy/evaluation/report/configuration_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

ConfigReader defaults() {
  return ConfigReader::from_string(default_config("everything"));
}

TEST(ConfigurationDifferences, AreNoneForTheDefaults) {
  EXPECT_EQ(configuration_differences(defaults().text()), "");
}

TEST(ConfigurationDifferences, NameKeyValueAndDefault) {
  ConfigReader config = defaults();
  config.overlay(ConfigReader::from_string("localizer: {window: 17}"));
  const std::string html = configuration_differences("# comment\n" + config.text());
  EXPECT_THAT(html, HasSubstr("<code>localizer.window</code>"));
  EXPECT_THAT(html, AllOf(HasSubstr("<td>17</td>"), HasSubstr("<td>40</td>")));
  EXPECT_THAT(html, Not(HasSubstr("fusion")));
}

TEST(ConfigurationDifferences, RefuseWhatIsNotYaml) {
  EXPECT_THROW(configuration_differences("a: [1"), ConfigError);
}

}  // namespace
}  // namespace fleetloc
