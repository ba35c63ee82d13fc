#include "deploy/evaluation/report/drawing.hpp"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/evaluation/report/gnuplot.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

TEST(Gnuplot, SaysWhatItDoesNotLike) {
  EXPECT_THAT([] { gnuplot_output("set terminal svg\nplod 1\n"); },
              ThrowsMessage<std::runtime_error>(AllOf(StartsWith("gnuplot: "), HasSubstr("plod"))));
}

TEST(Gnuplot, TakesAScriptLongerThanAPipeHolds) {
  const std::string comment(1 << 20, '#');
  EXPECT_EQ(gnuplot_output(comment + "\nset print '-'\nprint 'done'\n"), "done\n");
}

TEST(Drawing, IsAnElementWithIdsOfItsOwn) {
  Drawing drawing("one", "a <title>", 200);
  drawing.data("points", {{0.0, 1.0}, {}, {1.0, 2.0}});
  drawing.command("plot $points with points pointtype 6 title 'some'");
  const std::string svg = drawing.svg();
  EXPECT_THAT(svg, StartsWith("<svg role=\"img\" aria-label=\"a &lt;title&gt;\""));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_THAT(svg, AllOf(HasSubstr("id=\"one-gnuplot_canvas\""), HasSubstr("href='#one-gpPt5'")));
  EXPECT_THAT(svg, AllOf(HasSubstr("some"), HasSubstr("viewBox=\"0 0 480 200\"")));
  EXPECT_THAT(svg, AllOf(Not(HasSubstr("<?xml")), Not(HasSubstr("xlink")), Not(HasSubstr("'gp"))));
}

TEST(Thinned, KeepsThePeakOfEachInterval) {
  Series series;
  for (int i = 0; i < 1000; ++i) series.emplace_back(0.1 * i, i == 437 ? -9.0 : 1.0);
  const Series kept = thinned(series, 10);
  EXPECT_EQ(kept.size(), 10U);
  EXPECT_EQ(kept[4], (std::pair{43.7, -9.0}));
  EXPECT_EQ(thinned(series, 1000), series);
}

TEST(Steps, AreRound) {
  EXPECT_DOUBLE_EQ(tic_step(9.3, 7), 2.0);
  EXPECT_DOUBLE_EQ(tic_step(0.07, 7), 0.01);
  EXPECT_DOUBLE_EQ(tic_step(310.0, 7), 50.0);
  EXPECT_DOUBLE_EQ(tic_step(65.0, 7), 10.0);
  EXPECT_DOUBLE_EQ(rounded_down(0.019), 0.01);
  EXPECT_DOUBLE_EQ(rounded_down(0.6), 0.5);
  EXPECT_DOUBLE_EQ(rounded_down(3.0), 2.0);
}

TEST(Steps, AreNotBelowTheValueWhenRoundedUp) {
  EXPECT_DOUBLE_EQ(rounded_up(0.011), 0.02);
  EXPECT_DOUBLE_EQ(rounded_up(0.3), 0.5);
  EXPECT_DOUBLE_EQ(rounded_up(6.0), 10.0);
  EXPECT_DOUBLE_EQ(rounded_up(5.0), 5.0);
  EXPECT_EQ(log_tics(0.005, 0.02), "\"0.005\" 0.005, \"0.01\" 0.01, \"0.02\" 0.02");
  EXPECT_EQ(log_tics(1.5, 1.8), "");
}

TEST(PlotString, EscapesQuotes) {
  EXPECT_EQ(plot_string("a\"b\\c"), "\"a\\\"b\\\\c\"");
}

}  // namespace
}  // namespace fleetloc
