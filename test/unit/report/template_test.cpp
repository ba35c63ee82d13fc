#include "deploy/evaluation/report/template.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "deploy/evaluation/report/html.hpp"

namespace fleetloc {
namespace {

TEST(Template, ReplacesNamesByTheirValuesAndAbsentOnesByNothing) {
  EXPECT_EQ(filled("<p>{{a}}-{{b}}-{{c}}</p>", {{"a", "1"}, {"b", "{{c}}"}}),
            "<p>1-{{c}}-</p>");  // values are taken as they are
}

TEST(Template, KeepsABlockOnlyIfItsValueIsNotEmpty) {
  const std::string text = "{{#a}}<b>{{a}}{{x}}</b>{{/a}}{{^a}}no a{{/a}}";
  EXPECT_EQ(filled(text, {{"a", "1"}, {"x", "2"}}), "<b>12</b>");
  EXPECT_EQ(filled(text, {{"a", ""}}), "no a");
  EXPECT_EQ(filled(text, {}), "no a");
}

TEST(Template, KeepsBlocksWithinBlocks) {
  const std::string text = "{{#a}}({{^b}}no b{{/b}}{{#b}}b{{/b}}){{/a}}";
  EXPECT_EQ(filled(text, {{"a", "1"}}), "(no b)");
  EXPECT_EQ(filled(text, {{"a", "1"}, {"b", "1"}}), "(b)");
  EXPECT_EQ(filled(text, {{"b", "1"}}), "");
}

TEST(Template, RefusesWhatIsNotClosed) {
  EXPECT_THROW(filled("{{a", {}), std::logic_error);
  EXPECT_THROW(filled("{{#a}}", {{"a", "1"}}), std::logic_error);
}

TEST(Html, EscapesWhatWouldBeMarkup) {
  EXPECT_EQ(escaped("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
}

TEST(Html, WritesNumbersAsAReaderExpectsThem) {
  EXPECT_EQ(number_text(0.0125572, 3), "0.0126");
  EXPECT_EQ(number_text(114188288.0), "114188288");
  EXPECT_EQ(number_text(12345.6, 3), "12346");
  EXPECT_EQ(number_text(0.0), "0");
}

}  // namespace
}  // namespace fleetloc
