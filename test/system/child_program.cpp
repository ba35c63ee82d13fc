#include "test/system/child_program.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <unistd.h>

namespace fleetloc {
namespace {

std::filesystem::path new_file() {
  std::string name = (std::filesystem::temp_directory_path() / "fleetloc_child_XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) throw std::runtime_error("cannot make " + name);
  close(file);
  return name;
}

ChildCommand command(const std::string& program,
                     const std::vector<std::string>& arguments,
                     const std::filesystem::path& output,
                     const std::filesystem::path& errors) {
  ChildCommand command{.arguments = {program}, .output = output, .errors = errors};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace

ChildProgram::ChildProgram(const std::string& program, const std::vector<std::string>& arguments)
    : output_(new_file()),
      errors_(new_file()),
      process_(command(program, arguments, output_, errors_)) {}

ChildProgram::~ChildProgram() {
  std::error_code ignored;
  std::filesystem::remove(output_, ignored);
  std::filesystem::remove(errors_, ignored);
}

void ChildProgram::signal(int number) const {
  process_.signal(number);
}

std::string ChildProgram::output() const {
  return content_of(output_);
}

Outcome ChildProgram::wait() {
  const int exit_code = process_.wait().exit_code;
  return {.exit_code = exit_code, .output = content_of(output_), .errors = content_of(errors_)};
}

Outcome run(const std::string& program, const std::vector<std::string>& arguments) {
  return ChildProgram(program, arguments).wait();
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "fleetloc_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

}  // namespace fleetloc
