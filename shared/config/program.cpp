#include "shared/config/program.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <utility>

namespace fleetloc {
namespace {

/// What CLI11 says, without its second line.
int report(const std::string& name, const std::string& message, int exit_code) {
  std::cerr << name << ": " << message.substr(0, message.find('\n')) << '\n';
  return exit_code;
}

/// As a comment of one line; words that a shell would take apart stand in quotes.
std::string comment(const std::string& name, int argc, const char* const* argv) {
  std::string line = "# " + name + " " + FLEETLOC_VERSION + ":";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool is_plain = !word.empty() && word.find_first_of(" \t*?$'\"\\") == std::string::npos;
    line += is_plain ? " " + word : " '" + word + "'";
  }
  std::ranges::replace_if(
      line, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return line + "\n";
}

}  // namespace

Program::Program(std::string name, const std::string& description, std::string_view default_config)
    : name_(std::move(name)), default_config_(default_config), app_(description, name_) {
  app_.set_version_flag("--version", name_ + " " + FLEETLOC_VERSION);
  // Before --print-config, because options take effect in the order of their definition.
  app_.add_option("--config", config_file_, "YAML file with what differs from --print-config");
  app_.add_flag_callback(
      "--print-config",
      [this] { throw CLI::CallForVersion(config_text(), kSuccess); },
      "Print the configuration in effect and exit");
}

ConfigReader Program::config() const {
  auto reader = ConfigReader::from_string(default_config_, "defaults");
  if (!config_file_.empty()) reader.overlay(ConfigReader::from_file(config_file_));
  return reader;
}

std::string Program::config_text() const {
  if (config_file_.empty()) return std::string(default_config_);  // with comments
  return config().text();
}

int Program::run(int argc, const char* const* argv, const std::function<Run()>& prepare) {
  command_line_ = comment(name_, argc, argv);
  Run run;
  try {
    app_.parse(argc, argv);
    run = prepare();
  } catch (const CLI::Success& success) {  // --help and the like
    return app_.exit(success);
  } catch (const CLI::ParseError& error) {
    const auto unknown = app_.remaining(true);  // CLI11 complains of what is missing first
    const bool missing = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError);
    return report(
        name_,
        missing && !unknown.empty() ? "unknown argument " + unknown.front() : error.what(),
        kCannotStart);
  } catch (const std::exception& error) {
    return report(name_, error.what(), kCannotStart);
  }
  try {
    return run();
  } catch (const std::exception& error) {
    return report(name_, error.what(), kFailedAtRunTime);
  }
}

}  // namespace fleetloc
