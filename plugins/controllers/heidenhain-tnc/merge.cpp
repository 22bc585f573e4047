// SPDX-License-Identifier: Apache-2.0
#include "merge.h"

#include <algorithm>

#include "nonio/controllers/text.h"

namespace nonio::heidenhain_tnc {
namespace {

using controllers::lines_of;

bool is_table(const Artifact& a) {
  return a.bytes.rfind("BEGIN ", 0) == 0 && a.bytes.rfind("BEGIN CONFIG.CMA", 0) != 0;
}
bool is_assignment(const Artifact& a) { return a.bytes.rfind("BEGIN CONFIG.CMA", 0) == 0; }

std::string name_of(const Artifact& table) {
  const std::string_view rest = std::string_view(table.bytes).substr(6);
  return std::string(rest.substr(0, rest.find_first_of(" \r\n")));
}

struct Cell {
  std::size_t line = 0, column = 0, width = 0;
  std::string text{};
};

Expected<Cell> cell_of(const std::string& cma, const std::string& axis) {
  const auto lines = lines_of(cma);
  if (lines.size() < 3) return fail("CONFIG.CMA has no line");
  const auto headings = controllers::words_of(lines[1]);
  const auto heading = std::find(headings.begin(), headings.end(), axis);
  if (heading == headings.end()) return fail("CONFIG.CMA has no column " + axis);
  Cell cell;
  cell.column = static_cast<std::size_t>(heading->data() - lines[1].data());
  cell.width = heading + 1 == headings.end()
                   ? std::string::npos
                   : static_cast<std::size_t>((heading + 1)->data() - heading->data());
  std::vector<std::size_t> rows, active;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    if (lines[i].empty() || lines[i].front() < '0' || lines[i].front() > '9') continue;
    rows.push_back(i);
    if (lines[i].find('*') != std::string_view::npos) active.push_back(i);
  }
  if (active.size() != 1 && rows.size() != 1)
    return fail("CONFIG.CMA: expected one active line (*), found " + std::to_string(active.size()));
  cell.line = active.size() == 1 ? active.front() : rows.front();
  const std::string_view line = lines[cell.line];
  if (cell.column < line.size())
    cell.text = controllers::trimmed(line.substr(cell.column, cell.width));
  return cell;
}

Expected<std::string> filled(const std::string& cma, const Cell& cell, const std::string& text) {
  if (text.size() >= cell.width) return fail("CONFIG.CMA has no room for " + text);
  std::size_t at = 0;
  for (std::size_t i = 0; i < cell.line; ++i) at = cma.find('\n', at) + 1;
  std::size_t end = std::min(cma.find('\n', at), cma.size());
  if (end > at && cma[end - 1] == '\r') --end;
  std::string line = cma.substr(at, end - at);
  if (line.size() < cell.column + text.size()) line.resize(cell.column + text.size(), ' ');
  line.replace(cell.column, text.size(), text);
  return cma.substr(0, at) + line + cma.substr(end);
}

}  // namespace

Expected<std::vector<Artifact>> merge(const MergeInput& in) {
  const auto fresh = std::find_if(in.table.begin(), in.table.end(), is_table);
  if (fresh == in.table.end()) return fail("no new table of axis " + in.axis);
  const auto cma = std::find_if(in.backup.begin(), in.backup.end(), is_assignment);
  if (cma == in.backup.end())
    return fail(
        "expected CONFIG.CMA among the files of the backup: it states which table is whose");
  const auto cell = cell_of(cma->bytes, controllers::plain(in.axis));
  if (!cell) return fail(cell.error());
  const std::string name = cell->text.empty() ? name_of(*fresh) : cell->text;
  Artifact table = *fresh;
  table.bytes.replace(6, name_of(*fresh).size(), name);
  table.name = name;
  std::vector<Artifact> out;
  for (const Artifact& a : in.backup)
    if (is_table(a) && name_of(a) == name) {
      if (cell->text.empty())
        return fail("the backup has a table " + name + " that belongs to another axis");
      table.name = a.name;
    }
  out.push_back(std::move(table));
  if (cell->text.empty()) {
    auto text = filled(cma->bytes, *cell, name);
    if (!text) return fail(text.error());
    out.push_back({cma->name, std::move(*text)});
  }
  for (const Artifact& a : in.table)
    if (!is_table(a) && !is_assignment(a)) out.push_back(a);
  return out;
}

}  // namespace nonio::heidenhain_tnc
