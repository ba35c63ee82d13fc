#include "deploy/evaluation/report/report.hpp"

#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud/point_cloud/point_cloud_file.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/report/html.hpp"
#include "test/test_folder.hpp"
#include "test/unit/report/synthetic_run.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

std::size_t count(const std::string& page, std::string_view what) {
  std::size_t found = 0;
  for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) {
    ++found;
  }
  return found;
}

/// What stands between `begin` and the next `end`, wherever that occurs.
std::vector<std::string> between(const std::string& page,
                                 const std::string& begin,
                                 const std::string& end) {
  std::vector<std::string> found;
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    found.push_back(page.substr(at, page.find(end, at) - at));
  }
  return found;
}

std::vector<std::string> figure_labels(const std::string& page) {
  return between(page, "aria-label=\"", "\"");
}

/// Names of the tags that are opened and not closed in the right order; empty for a sound page.
std::string nesting_fault(const std::string& page) {
  const std::set<std::string> void_tags{"!DOCTYPE", "meta", "br", "link"};
  std::vector<std::string> open;
  for (const std::string& tag : between(page, "<", ">")) {
    const std::string name = tag.substr(0, tag.find_first_of(" \n/", 1));
    if (void_tags.contains(name) || tag.ends_with("/")) continue;
    if (!tag.starts_with("/")) {
      open.push_back(name);
    } else if (open.empty() || "/" + open.back() != tag) {
      return (open.empty() ? "nothing" : open.back()) + " was closed by " + tag;
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back() + " is not closed";
}

class ReportPage : public testing::Test {
 protected:
  ReportPage() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] ReportRun run(const std::string& name, bool with_answers = true) const {
    write_run(folder_ / name, with_answers);
    const nlohmann::json statistics{
        {"median", 0.02}, {"mean", 0.02}, {"rmse", 0.025}, {"std", 0.01}, {"max", 0.07}};
    return {.folder = folder_ / name,
            .evaluation = {{"ate", statistics},
                           {"aligned_once",
                            {{"ate", statistics}, {"ratio", {{"median", 11.5}, {"rmse", 12.25}}}}},
                           {"covered", 0.875},
                           {"nees", {{"map", 1.125}, {"odom", nullptr}}}},
            .truth = true_trajectory()};
  }

  [[nodiscard]] static ReportInput input(std::vector<ReportRun> runs) {
    return {.runs = std::move(runs),
            .map = std::nullopt,
            .sessions = {},
            .max_gap = std::chrono::milliseconds(150)};
  }

  const std::filesystem::path folder_ =
      test_folder() / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ReportPage, HasOneDrawingForEachFigure) {
  const std::string page = report_page(input({run("robot_1")}));
  EXPECT_THAT(figure_labels(page),
              testing::ElementsAre("localized, from above",
                                   "aligned once, from above",
                                   "odometry alone, from above",
                                   "errors of position over time",
                                   "errors and three sigmas over time",
                                   "states and answers over time",
                                   "payload per second, up and down",
                                   "round trip and loss over time"));
  EXPECT_EQ(count(page, "<svg"), 8U);
  EXPECT_EQ(count(page, "<figure>"), 8U);
  EXPECT_EQ(count(page, "<figcaption>"), 8U);
}

TEST_F(ReportPage, HoldsEveryFigureOfSummaryAndEvaluation) {
  const ReportRun its = run("robot_1");
  const std::string page = report_page(input({its}));
  std::ifstream stream(its.folder / "summary.json");
  const nlohmann::json flat = nlohmann::json::parse(stream).flatten();
  ASSERT_GT(flat.size(), 25U);
  for (const auto& [pointer, value] : flat.items()) {
    std::string name = pointer.substr(1);
    std::ranges::replace(name, '/', '.');
    EXPECT_THAT(page, HasSubstr("<code>" + name + "</code>"));
  }
  for (const char* row : {"<code>submaps_sent</code></th><td>4711</td>",
                          "<code>tracking_ms.p99</code></th><td>3.25</td>",
                          "<code>input_faults.imu_gaps</code></th><td>2</td>",
                          "<code>nees.map</code></th><td>1.125</td>",
                          "<code>nees.odom</code></th><td>–</td>",
                          "<code>aligned_once.ratio.rmse</code></th><td>12.25</td>"}) {
    EXPECT_THAT(page, HasSubstr(row));
  }
  EXPECT_THAT(page, HasSubstr("<code>aligned_once.ate</code></th><td>0.02</td><td>0.02</td>"));
}

TEST_F(ReportPage, NeedsNothingFromElsewhere) {
  const std::string page = report_page(input({run("robot_1")}));
  EXPECT_EQ(count(page, "://"), count(page, " xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_THAT(page,
              AllOf(Not(HasSubstr("src=")), Not(HasSubstr("url(")), Not(HasSubstr("@import"))));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("<script")), Not(HasSubstr("<link"))));
  EXPECT_THAT(between(page, "href='", "'"), Each(StartsWith("#")));
}

TEST_F(ReportPage, IsSoundHtmlWithUniqueIds) {
  const std::string page = report_page(input({run("robot_1"), run("robot_2")}));
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>\n<html lang=\"en\">"));
  EXPECT_THAT(page, HasSubstr("<meta name=\"viewport\" content=\"width=device-width"));
  EXPECT_EQ(nesting_fault(page), "");
  std::vector<std::string> ids = between(page, " id=\"", "\"");
  const auto more = between(page, " id='", "'");
  ids.insert(ids.end(), more.begin(), more.end());
  const std::set<std::string> unique(ids.begin(), ids.end());
  EXPECT_EQ(unique.size(), ids.size());
  for (const auto& references : {between(page, "href='#", "'"), between(page, "href=\"#", "\"")}) {
    ASSERT_FALSE(references.empty());
    for (const std::string& id : references) EXPECT_TRUE(unique.contains(id)) << id;
  }
}

TEST_F(ReportPage, IsTheSameForTheSameInput) {
  const ReportInput once = input({run("robot_1")});
  EXPECT_TRUE(report_page(once) == report_page(once));
}

TEST_F(ReportPage, HasARowAndASectionForEachRun) {
  const std::string page = report_page(input({run("robot_1"), run("robot_2"), run("<3&4>")}));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\"><a href=\"#run2\">robot_2</a></th>"));
  EXPECT_THAT(page, HasSubstr("<section id=\"run2\">\n<h2>robot_2</h2>"));
  EXPECT_EQ(count(page, ">covered [%]</th>"), 1U);
  EXPECT_EQ(count(page, "<td>87.5</td>"), 3U);
  EXPECT_THAT(page, HasSubstr("<h2>&lt;3&amp;4&gt;</h2>"));
  EXPECT_EQ(count(page, "<section id=\"run"), 3U);
  EXPECT_EQ(count(page, "<svg"), 24U);
}

TEST_F(ReportPage, SaysWhatARunWithoutAnswersCannotShow) {
  const std::string page = report_page(input({run("robot_1", false)}));
  EXPECT_THAT(page, HasSubstr("no answer was ever applied"));
  EXPECT_THAT(page, HasSubstr("No bytes were sent"));
  EXPECT_THAT(page, HasSubstr("No round trip was measured"));
  EXPECT_THAT(figure_labels(page),
              testing::ElementsAre("odometry alone, from above",
                                   "errors of position over time",
                                   "states and answers over time"));
  EXPECT_EQ(nesting_fault(page), "");
}

TEST_F(ReportPage, ShowsWithoutGroundTruthWhatDoesNotNeedIt) {
  ReportRun its = run("robot_1");
  its.truth.reset();
  its.evaluation = nullptr;
  const std::string page = report_page(input({its}));
  EXPECT_THAT(page, HasSubstr("No ground truth was given"));
  EXPECT_THAT(page, HasSubstr("There is a run without ground truth"));
  EXPECT_THAT(page, Not(HasSubstr("Those in the tables")));
  EXPECT_THAT(figure_labels(page),
              testing::ElementsAre("localized and aligned once, from above",
                                   "states and answers over time",
                                   "payload per second, up and down",
                                   "round trip and loss over time"));
  EXPECT_THAT(page, AllOf(HasSubstr("<code>submaps_sent</code>"), Not(HasSubstr("<h3>Errors"))));
  EXPECT_EQ(nesting_fault(page), "");
}

TEST_F(ReportPage, SaysThatAnEvaluationIsAnEarlierOne) {
  ReportRun its = run("robot_1");
  its.truth.reset();
  const std::string page = report_page(input({its}));
  EXPECT_THAT(page, AllOf(HasSubstr("Those in the tables"), HasSubstr("<h3>Errors")));
}

TEST_F(ReportPage, ComparesInOneViewAndScale) {
  const std::string page = report_page(input({run("robot_1")}));
  const auto drawings = between(page, "<svg", "</svg>");
  const auto texts = between(drawings.at(0), "<text>", "</text>");  // at the axes and colours
  // The error in the map is 0.02 m, the drift of the odometry 0.6 m at last.
  EXPECT_THAT(texts, AllOf(Contains(HasSubstr("0.02")), Contains(HasSubstr("1"))));
  EXPECT_EQ(between(drawings.at(1), "<text>", "</text>"), texts);
  EXPECT_EQ(between(drawings.at(2), "<text>", "</text>"), texts);
  EXPECT_THAT(page, HasSubstr("its median is 11.5 times and its rmse 12.2 times"));
  // 0.02 m of one sigma 0.01 m, and no error of yaw: all within three sigmas.
  EXPECT_THAT(page, HasSubstr("100 % of all values do"));
}

TEST_F(ReportPage, DrawsTheMapUnderTheTrajectories) {
  ReportInput with_map = input({run("robot_1")});
  const std::string before = report_page(with_map);
  std::vector<Eigen::Vector3f> wall;
  for (int i = 0; i < 4000; ++i) {
    const auto step = static_cast<float>(i % 400);
    wall.emplace_back(-5.0F + 0.025F * step, 3.5F, 0.3F * static_cast<float>(i) / 400.0F);
  }
  with_map.map = folder_ / "map.ply";
  write_ply(*with_map.map, wall);
  const std::string page = report_page(with_map);
  EXPECT_THAT(page, HasSubstr("Grey is the laser map"));
  EXPECT_EQ(count(before, "stroke='rgb(188, 188, 188)'"), 0U);
  EXPECT_EQ(count(page, "stroke='rgb(188, 188, 188)'"), 3U);
}

TEST_F(ReportPage, ShowsTheTimesOfTheLocalizers) {
  ReportInput with_sessions = input({run("robot_1")});
  const auto file = folder_ / "localizer_1" / "sessions.json";
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file)
      << R"({"robot_1": {"submaps": 77, "localized": 70, "rejected": {"poor_fit": 7},
      "optimize_ms": {"p50": 12.5, "p99": 37.5}, "matches": {"p50": 210}, "memory_bytes": 1048576}})";
  with_sessions.sessions = {file};
  const std::string page = report_page(with_sessions);
  EXPECT_THAT(page,
              HasSubstr("<th scope=\"row\">localizer_1 / robot_1</th><td>77</td><td>70</td>"
                        "<td>{&quot;poor_fit&quot;:7}</td><td>12.5</td><td>37.5</td><td>210</td>"
                        "<td>1048576</td>"));
  EXPECT_EQ(count(page, "<svg"), 9U);
}

TEST_F(ReportPage, ShowsTheConfigurationThatTheRunUsed) {
  const ReportRun its = run("robot_1");
  EXPECT_THAT(report_page(input({its})), HasSubstr("holds no <code>config.yaml</code>"));
  std::ofstream(its.folder / "config.yaml") << "# fleetloc-replay 0.1.0: --loss 0.2\n"
                                            << default_config("everything");
  const std::string page = report_page(input({its}));
  EXPECT_THAT(page, HasSubstr("<pre>fleetloc-replay 0.1.0: --loss 0.2</pre>"));
  EXPECT_THAT(page, HasSubstr("All values are the defaults."));
  EXPECT_THAT(page, HasSubstr(escaped(default_config("robot"))));
}

TEST_F(ReportPage, NamesTheFileThatIsMissing) {
  const ReportRun its = run("robot_1");
  for (const char* name : {"summary.json",
                           "odometry.tum",
                           "localization_frames.tum",
                           "diagnostics.csv",
                           "answers.csv"}) {
    const auto file = its.folder / name;
    const auto aside = folder_ / "aside";
    std::filesystem::rename(file, aside);
    EXPECT_THAT([&] { report_page(input({its})); },
                ThrowsMessage<std::runtime_error>(HasSubstr(file.string())));
    std::filesystem::rename(aside, file);
  }
  ReportInput with_map = input({its});
  with_map.map = folder_ / "none.pcd";
  EXPECT_THAT([&] { report_page(with_map); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.pcd")));
}

}  // namespace
}  // namespace fleetloc
