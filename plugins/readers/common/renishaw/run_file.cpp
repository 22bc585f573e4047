// SPDX-License-Identifier: Apache-2.0
#include "run_file.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>

#include "lines.h"
#include "runs.h"

namespace nonio::renishaw {
using namespace readers;

namespace {

constexpr std::uint32_t most_targets = 100000, most_runs = 10000;
constexpr std::size_t user_lines = 7;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Block {
  std::uint64_t line = 0;
  std::vector<FileLine> lines;
};
using Blocks = std::map<std::string, Block, std::less<>>;

struct KeyValue {
  std::string_view key, value;
};
KeyValue split_key(std::string_view line) {
  const std::size_t colon = std::min(line.find(':'), line.size());
  return {trimmed(line.substr(0, colon)), trimmed(line.substr(std::min(colon + 1, line.size())))};
}

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

/// "TARGET DATA" for the line "TARGET DATA::"; empty for any other line.
std::string_view block_name(std::string_view line) {
  line = trimmed(line);
  if (line.size() < 3 || !line.ends_with("::")) return {};
  line.remove_suffix(2);
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == ' ' || c == '-';
  };
  return std::all_of(line.begin(), line.end(), allowed) ? line : std::string_view{};
}

/// Read first, because some file types contain binary data.
std::string_view type_of(std::string_view head) {
  Lines lines(head);
  std::string_view line;
  bool begun = false;
  for (int i = 0; i < 30 && lines.next(line); ++i) {
    if (trimmed(line).empty()) continue;
    if (!begun && block_name(line) != "HEADER") return {};
    const auto [key, value] = split_key(line);
    if (begun && same_letters(key, "File type")) return value;
    begun = true;
  }
  return {};
}

Error other_type(std::string_view found, std::string_view wanted) {
  std::string text = "expected a file of type " + std::string(wanted) + ", found " + shown(found);
  if (same_letters(found, "rtl")) return Error{text + "; reader renishaw-rtl takes it"};
  if (same_letters(found, "rta"))
    return Error{text + "; reader renishaw-rta takes it once its unit is confirmed"};
  if (same_letters(found, "rtx"))
    return Error{text +
                 ", a dynamic capture: the unit of its samples is not known. Needed: such a file "
                 "with the values that the instrument's program shows for it"};
  if (same_letters(found, "stx") || same_letters(found, "stz"))
    return Error{text +
                 ", a straightness: its layout is not known. Needed: such a file with the values "
                 "that the instrument's program shows for it"};
  return Error{text + ". Needed: such a file with the values that the instrument's program shows"};
}

Expected<Blocks> blocks_of(std::string_view bytes) {
  Blocks blocks;
  Lines lines(bytes);
  std::string_view line;
  Block* block = nullptr;
  bool ended = false;
  while (lines.next(line)) {
    if (line.size() > longest_line)
      return fail(at_line(lines.number(), "expected lines of at most " +
                                              std::to_string(longest_line) + " bytes, found " +
                                              std::to_string(line.size())));
    if (trimmed(line).empty()) continue;
    if (ended)
      return fail(at_line(lines.number(), "expected nothing after EOF::, found " + shown(line)));
    if (line.find('\0') != line.npos)
      return fail(at_line(lines.number(), "expected text, found a NUL byte; is the file UTF-16?"));
    const std::string_view name = block_name(line);
    if (name.empty()) {
      if (block == nullptr)
        return fail(at_line(lines.number(), "expected HEADER::, found " + shown(line)));
      block->lines.push_back({lines.number(), line});
      continue;
    }
    ended = name == "EOF";
    const auto [place, fresh] = blocks.try_emplace(std::string(name));
    if (!fresh)
      return fail(at_line(lines.number(), "block " + std::string(name) + " was there in line " +
                                              std::to_string(place->second.line)));
    block = &place->second;
    block->line = lines.number();
  }
  if (!ended)
    return fail(at_line(lines.number(),
                        "expected EOF:: at the end, found the end of the file; was it cut?"));
  return blocks;
}

Expected<const Block*> block(const Blocks& blocks, std::string_view name) {
  const auto found = blocks.find(name);
  if (found == blocks.end())
    return fail("expected a block " + std::string(name) + "::, found none");
  return &found->second;
}

Expected<FileLine> value_of(const Block& in, std::string_view key) {
  for (const FileLine& line : in.lines)
    if (const auto [k, value] = split_key(line.text); same_letters(k, key))
      return FileLine{line.number, value};
  return fail(at_line(in.line, "expected a line \"" + std::string(key) + ":\" in this block"));
}

Expected<std::uint32_t> count_of(const Block& in, std::string_view key, std::uint32_t most) {
  NONIO_TRY(const auto value, value_of(in, key));
  if (const std::uint32_t n = whole_number(value.text, most); n != 0) return n;
  return fail(at_line(value.number, std::string(key) + ": expected a whole number from 1 to " +
                                        std::to_string(most) + ", found " + shown(value.text)));
}

class Parser {
 public:
  explicit Parser(const Blocks& blocks) : blocks_(blocks) {}

  Expected<RunFile> parse(std::string_view wanted_type, std::string_view wanted_owner) {
    if (auto ok = header(wanted_type, wanted_owner); !ok) return fail(ok.error());
    if (auto ok = targets(); !ok) return fail(ok.error());
    if (auto ok = user_text(); !ok) return fail(ok.error());
    if (auto ok = rows(); !ok) return fail(ok.error());
    if (auto ok = environment(); !ok) return fail(ok.error());
    return std::move(file_);
  }

 private:
  Expected<void> header(std::string_view wanted_type, std::string_view wanted_owner) {
    NONIO_TRY(const auto in, block(blocks_, "HEADER"));
    const auto type = value_of(*in, "File type"), owner = value_of(*in, "Owner");
    if (!type) return fail(type.error());
    if (!same_letters(type->text, wanted_type)) {
      Error error = other_type(type->text, wanted_type);
      error.line = type->number;
      return fail(std::move(error));
    }
    if (!owner) return fail(owner.error());
    if (!wanted_owner.empty() && owner->text != wanted_owner)
      return fail(at_line(owner->number, "Owner: expected " + std::string(wanted_owner) +
                                             ", found " + shown(owner->text) +
                                             ". Needed: such a file with the values that the "
                                             "instrument's program shows for it"));
    file_.type = type->text;
    file_.owner = owner->text;
    if (const auto version = value_of(*in, "Version no")) file_.version = version->text;
    return {};
  }

  Expected<void> targets() {
    NONIO_TRY(const auto in, block(blocks_, "TARGET DATA"));
    NONIO_TRY(const auto count, count_of(*in, "Target-count", most_targets));
    bool list = false;
    std::uint64_t last = in->line;
    for (const FileLine& line : in->lines) {
      const auto [key, value] = split_key(line.text);
      if (same_letters(key, "Flags") && line.text.find(':') != line.text.npos) {
        flags(value);
        list = false;
      } else if (same_letters(key, "Targets") && line.text.find(':') != line.text.npos) {
        list = true;
      } else if (list) {
        if (auto ok = target_line(line); !ok) return ok;
        last = line.number;
      }
    }
    if (file_.targets.size() != count)
      return fail(at_line(last, "expected " + std::to_string(count) +
                                    " targets (Target-count), found " +
                                    std::to_string(file_.targets.size())));
    if (sense_of(file_.targets) == 0)
      return fail(at_line(last, "expected two targets or more that only rise or only fall"));
    return {};
  }

  Expected<void> target_line(const FileLine& line) {
    for (const std::string_view field : by_blanks(line.text)) {
      NONIO_TRY(const auto target, numbers_.number(field, line.number, "a target"));
      file_.targets.push_back(target);
    }
    return {};
  }

  void flags(std::string_view text) {
    for (const std::string_view field : by_blanks(text)) {
      std::int64_t flag = 0;
      const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), flag);
      if (error == std::errc{} && end == field.data() + field.size()) file_.flags.push_back(flag);
    }
  }

  Expected<void> user_text() {
    const auto found = blocks_.find("USER-TEXT");
    if (found == blocks_.end()) return {};
    const Block& in = found->second;
    if (in.lines.size() != user_lines)
      return fail(at_line(in.line, "expected " + std::to_string(user_lines) +
                                       " lines in USER-TEXT, found " +
                                       std::to_string(in.lines.size())));
    file_.user = in.lines;
    return {};
  }

  Expected<void> rows() {
    const auto runs = block(blocks_, "RUNS"), in = block(blocks_, "DEVIATIONS");
    if (!runs) return fail(runs.error());
    if (!in) return fail(in.error());
    NONIO_TRY(const auto count, count_of(**runs, "Run-count", most_runs));
    file_.run_count = count;
    const std::size_t n = file_.targets.size();
    const std::size_t wanted = n * count;
    std::vector<FileLine> lines = (*in)->lines;
    if (!lines.empty() && same_letters(split_key(lines[0].text).key, "Run Target Data"))
      lines.erase(lines.begin());
    if (lines.size() != wanted)
      return fail(at_line((*in)->line, "expected " + std::to_string(wanted) + " rows (" +
                                           std::to_string(count) + " runs of " + std::to_string(n) +
                                           " targets), found " + std::to_string(lines.size())));
    std::vector<std::uint64_t> seen(wanted, 0);
    for (const FileLine& line : lines)
      if (auto ok = row(line, seen); !ok) return ok;
    return {};
  }

  Expected<void> row(const FileLine& line, std::vector<std::uint64_t>& seen) {
    const auto fields = by_blanks(line.text);
    if (fields.size() != 3)
      return fail(at_line(line.number,
                          "expected run, target number and deviation, found " + shown(line.text)));
    const std::size_t n = file_.targets.size();
    RunFile::Row row;
    row.line = line.number;
    row.run = whole_number(fields[0], file_.run_count);
    row.target = whole_number(fields[1], static_cast<std::uint32_t>(n));
    if (row.run == 0)
      return fail(at_line(line.number, "expected a run from 1 to " +
                                           std::to_string(file_.run_count) + ", found " +
                                           shown(fields[0])));
    if (row.target == 0)
      return fail(at_line(line.number, "expected a target number from 1 to " + std::to_string(n) +
                                           ", found " + shown(fields[1])));
    NONIO_TRY(const auto value, numbers_.reading(fields[2], line.number, "a deviation"));
    row.value = value;
    std::uint64_t& first = seen[(row.run - 1) * n + row.target - 1];
    if (first != 0)
      return fail(at_line(line.number, "run " + std::to_string(row.run) + ", target " +
                                           std::to_string(row.target) + " was there in line " +
                                           std::to_string(first)));
    first = line.number;
    file_.rows.push_back(row);
    return {};
  }

  Expected<Environment::Pair> pair(const FileLine& line, std::string_view value) {
    const auto fields = by_blanks(value);
    if (fields.size() < 2)
      return fail(at_line(line.number, "expected a value at the start and one at the end, found " +
                                           shown(line.text)));
    const auto start = numbers_.reading(fields[0], line.number, "a number"),
               end = numbers_.reading(fields[1], line.number, "a number");
    if (!start) return fail(start.error());
    if (!end) return fail(end.error());
    return Environment::Pair{*start, *end};
  }

  Expected<void> environment() {
    const auto found = blocks_.find("ENVIRONMENT");
    if (found == blocks_.end()) return {};
    const Environment::Pair none{nan, nan};
    Environment e{none, none, none, {}, 0, none, none, {}};
    for (const FileLine& line : found->second.lines) {
      const auto [key, value] = split_key(line.text);
      if (same_letters(key, "Date Time")) e.times = value;
      Environment::Pair* to = same_letters(key, "Air temp")     ? &e.air
                              : same_letters(key, "Air press")  ? &e.pressure
                              : same_letters(key, "Air humid")  ? &e.humidity
                              : same_letters(key, "Env factor") ? &e.factor
                              : same_letters(key, "Exp coeff")  ? &e.expansion
                                                                : nullptr;
      const bool material = same_letters(key.substr(0, 8), "Mat temp");
      if (to == nullptr && !material) continue;
      NONIO_TRY(const auto values, pair(line, value));
      if (to != nullptr)
        *to = values;
      else if (values.start == -10.0 && values.end == -10.0)
        ++e.unconnected;
      else
        e.material.push_back(values);
    }
    file_.environment = std::move(e);
    return {};
  }

  const Blocks& blocks_;
  Numbers numbers_{true};
  RunFile file_;
};

}  // namespace

bool is_type(std::string_view head, std::string_view type) {
  const std::string_view found = type_of(head);
  return !found.empty() && same_letters(found, type);
}

Expected<RunFile> parse_run_file(std::string_view bytes, std::string_view type,
                                 std::string_view owner) {
  if (const std::string_view found = type_of(bytes); !found.empty() && !same_letters(found, type))
    return fail(other_type(found, type));
  NONIO_TRY(const auto blocks, blocks_of(bytes));
  return Parser(blocks).parse(type, owner);
}

}  // namespace nonio::renishaw
