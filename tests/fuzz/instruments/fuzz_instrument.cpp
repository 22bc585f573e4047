// SPDX-License-Identifier: Apache-2.0
// Any bytes give observations that hold together, or an error in readable words. The reader is the one whose corpus is
// given.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "camonitor.h"
#include "ecmc_iso230.h"
#include "linuxcnc_probe.h"
#include "long_table.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/plugin.h"
#include "rta.h"
#include "rtl.h"
#include "wide_table.h"

namespace {

void must(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "does not hold: " << what << std::endl;
  std::abort();
}

void must_be_words(const std::string& words) {
  must(nonio::is_utf8(words), "words are UTF-8");
  for (const char c : words)
    must(static_cast<unsigned char>(c) >= 0x20, "words have no control characters");
}

void check_error(const nonio::Error& error, std::string_view bytes) {
  must(!error.message.empty() && error.message.size() < 4000, "an error has words, and is short");
  must_be_words(error.message);
  must(error.line <= bytes.size() + 1, "a line is a line of the file");
}

void check_observations(const nonio::Observations& o, std::string_view bytes) {
  const std::size_t n = o.size();
  for (const nonio::Remark& note : o.notes) {
    for (const auto& [name, text] : note.texts) must_be_words(text);
    for (const nonio::Number& number : note.evidence)
      must(!std::isinf(number.value), "evidence is a number");
  }
  if (o.axes.empty()) {
    must(n == 0 && !o.notes.empty(), "without axes there are only notes");
    return;
  }
  must(n > 0 && n + o.missing <= 3 * bytes.size(), "there are readings, and no more than rows");
  must(o.run.size() == n && o.source_line.size() == n, "run and line of each reading");
  must(o.u.empty() || o.u.size() == n, "an uncertainty for each reading, or for none");
  for (const auto* column : {&o.time, &o.material, &o.air, &o.pressure, &o.humidity})
    must(column->empty() || column->size() == n, "columns are of one size");
  for (const auto& axis : o.axes)
    must(axis.position.size() == n && (axis.approach.empty() || axis.approach.size() == n),
         "a position of each axis");
  std::set<std::tuple<std::uint32_t, int, double, std::uint32_t>> keys;
  for (std::size_t i = 0; i < n; ++i) {
    must(std::isfinite(o.deviation[i]) && std::fabs(o.deviation[i]) < 1e19, "no mark is a value");
    must(o.run[i] >= 1 && o.source_line[i] >= 1, "run and line from 1");
    for (const auto& axis : o.axes) must(std::isfinite(axis.position[i]), "finite");
    must(o.u.empty() || (std::isfinite(o.u[i]) && o.u[i] > 0.0), "an uncertainty is positive");
    if (o.axes[0].approach.empty()) continue;
    must(std::abs(o.axes[0].approach[i]) == 1, "a direction");
    must(keys.emplace(o.run[i], o.axes[0].approach[i], o.axes[0].position[i],
                      o.line.empty() ? 0 : o.line[i])
             .second,
         "a reading is there once");
  }
}

using MakeReader = nonio::Reader (*)();
MakeReader reader_of_corpus(const std::string& name) {
  const std::map<std::string, MakeReader> readers{
      {"camonitor", nonio::camonitor::reader},
      {"ecmc-iso230", nonio::ecmc_iso230::reader},
      {"linuxcnc-probe", nonio::linuxcnc_probe::reader},
      {"long-table", nonio::long_table::reader},
      {"renishaw-rta", nonio::renishaw::rta_reader},
      {"renishaw-rtl", nonio::renishaw::rtl_reader},
      {"wide-table", nonio::wide_table::reader},
  };
  const auto found = readers.find(name);
  return found == readers.end() ? nullptr : found->second;
}

/// A machine, and options that make readers read.
struct World {
  nonio::Reader reader;
  nonio::Campaign campaign;
  nonio::Measurement measurement;

  explicit World(nonio::Reader of) : reader(std::move(of)) {
    nonio::Axis axis;
    const bool rotary = reader.info.name == "renishaw-rta" || reader.info.name == "linuxcnc-probe";
    axis.name = rotary ? "C" : "X";
    axis.rotary = rotary;
    axis.expansion = 11.7e-6;
    campaign.machine.axes.push_back(axis);
    nonio::Axis other;
    other.name = "Y";
    campaign.machine.axes.push_back(other);
    measurement.id = "m";
    measurement.axis = axis.name;
    for (const char* kind : {"axis", "ball-centres"})
      if (measurement.kind.empty() && reader.reads(kind)) measurement.kind = kind;
  }

  nonio::Settings options(std::string_view bytes) const {
    nonio::Settings s;
    for (const nonio::Option& o : reader.info.options) s.values[o.name] = o.default_value;
    const auto set = [&](const char* name, nonio::Setting value) {
      if (s.has(name)) s.values[name] = std::move(value);
    };
    set("unit", std::string(reader.info.name == "renishaw-rta" ? "mrad" : "mm"));
    set("sign", std::string("+"));
    set("target_pv", std::string("A:PosSet"));
    set("reference_pv", std::string("L:Pos"));
    set("test_pv", std::string("T:Number"));
    set("target_unit", std::string("mm"));
    set("reference_unit", std::string("mm"));
    set("value_unit", std::string("um"));
    const bool print = bytes.starts_with("801");
    const char* const separator = bytes.find(';') != bytes.npos   ? ";"
                                  : bytes.find('|') != bytes.npos ? "|"
                                  : bytes.find(',') != bytes.npos ? ","
                                                                  : "blank";
    set("separator", std::string(separator));
    set("values", std::string("actual - target"));
    std::vector<std::string> columns{"target", "1 forward", "1 reverse", "2 +"};
    if (print)
      columns = {"target",     "mean forward", "mean reverse", "mean",
                 "2s forward", "2s reverse",   "dead zone"};
    if (reader.info.name == "long-table") {
      columns = {"cycle", "pos", "target", "value"};
      if (bytes.find('+') != bytes.npos) columns.push_back("direction");
    }
    const bool tables = bytes.find("table") != bytes.npos;
    if (columns.back() == "value" || tables)
      set("tables", std::vector<std::string>{"2-4 forward", "6- reverse"});
    if (reader.info.name == "wide-table" && tables) columns = {"target", "1", "2", "3"};
    set("columns", columns);
    set("code_page", std::string(bytes.size() % 2 == 0 ? "windows-1251" : "utf-8"));
    set("touches", std::int64_t{bytes.size() % 4 == 0 ? 5 : 0});
    return s;
  }
};

std::optional<World> chosen;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  for (int i = 1; i < *count; ++i)
    if (const MakeReader make =
            reader_of_corpus(std::filesystem::path((*arguments)[i]).filename().string()))
      chosen.emplace(make());
  must(chosen.has_value(), "an argument is the corpus of a reader");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const World& world = *chosen;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  world.reader.recognises(bytes);
  const nonio::Settings options = world.options(bytes);
  const auto read = world.reader.read({bytes, world.campaign, world.measurement, options, {}});
  if (read)
    check_observations(*read, bytes);
  else
    check_error(read.error(), bytes);
  return 0;
}
