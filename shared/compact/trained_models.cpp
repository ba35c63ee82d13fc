#include "shared/compact/trained_models.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "shared/compact/compact_models_text.hpp"

namespace fleetloc {
namespace {

using Shares = std::vector<std::uint8_t>;

[[noreturn]] void fail(const std::string& row, const std::string& what) {
  throw std::invalid_argument("the table of models: " + row + ": " + what);
}

Shares read_shares(const std::string& row, std::istream& words) {
  Shares shares;
  for (std::string word; words >> word;) {
    const bool is_number = word.size() <= 3 && word.find_first_not_of("0123456789") == word.npos;
    const int share = is_number ? std::stoi(word) : 0;
    if (share < 1 || share > 255) fail(row, word + " is no share in 1/256");
    shares.push_back(static_cast<std::uint8_t>(share));
  }
  if (shares.empty()) fail(row, "no shares");
  return shares;
}

std::map<std::string, Shares> read_rows(std::string_view table) {
  std::map<std::string, Shares> rows;
  std::istringstream lines{std::string(table)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name;
    if (!(words >> name)) continue;
    if (!rows.emplace(name, read_shares(name, words)).second) fail(name, "a second row");
  }
  return rows;
}

}  // namespace

CompactModels read_models(std::string_view table) {
  std::map<std::string, Shares> rows = read_rows(table);
  CompactModels models;
  for_each_row(models, [&](const std::string& name, std::span<BitModel> row) {
    const auto node = rows.extract(name);
    if (node.empty()) fail(name, "no row");
    const Shares& shares = node.mapped();
    if (shares.size() > row.size()) fail(name, "more shares than models");
    for (std::size_t i = 0; i < shares.size(); ++i) row[i] = BitModel(shares[i]);
  });
  if (!rows.empty()) fail(rows.begin()->first, "no such models");
  return models;
}

const CompactModels& trained_models() {
  static const CompactModels models = read_models(kCompactModelsText);
  return models;
}

}  // namespace fleetloc
