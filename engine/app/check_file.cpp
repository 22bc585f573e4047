// SPDX-License-Identifier: Apache-2.0
#include "check_file.h"

#include <algorithm>
#include <iostream>

#include "campaign/config/manifest.h"
#include "campaign/loader/plugins.h"
#include "campaign/reading/checked_read.h"
#include "campaign/reading/stated_table.h"
#include "campaign/reading/unknown_format.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "printable.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_rows = 6, most_points = 20'000;

struct Read {
  const Reader* reader = nullptr;
  std::string axis{};
  Observations readings{};
};

class FileCheck {
 public:
  FileCheck(const fs::path& file, const FileWish& wish, const Common& common)
      : name_(file.filename().string()), columns_(wish.columns), common_(common) {
    if (!wish.axis.empty()) axes_.insert(axes_.begin(), wish.axis);
  }

  int run(const fs::path& file) {
    plugins_.load(common_.plugin_folders());
    const auto bytes = storage::read_file(file);
    if (!bytes) return complain(text_of(bytes.error()));
    const auto converted = utf8_of_utf16(*bytes);
    if (!converted) return report(fail(converted.error()), {});
    const std::string& text = *converted ? **converted : *bytes;
    std::optional<reading::StatedTable> table;
    if (!columns_.empty()) table = reading::stated_table(plugins_, text, most_rows);
    const auto got = read(text, table);
    if (!got && !table) table = reading::stated_table(plugins_, text, most_rows);
    return report(got, table);
  }

 private:
  const Reader* reader_of(std::string_view bytes,
                          const std::optional<reading::StatedTable>& table) const {
    if (!columns_.empty()) return table ? table->reader : nullptr;
    for (const Reader& r : plugins_.readers())
      if (r.reads("axis") && r.recognises(reading::head_of(bytes))) return &r;
    return nullptr;
  }

  Expected<Read> read(const std::string& bytes,
                      const std::optional<reading::StatedTable>& table) const {
    const Reader* const reader = reader_of(bytes, table);
    if (reader == nullptr)
      return fail("no reader recognizes the format of this file: " +
                  reading::what_is_wrong(bytes, name_));
    config::RawOptions stated;
    if (!columns_.empty())
      stated[reader->info.name][reading::columns_option] = {Setting(columns_), name_, 0};
    const auto options = config::settle_options(reader->info, {}, stated);
    if (!options) return fail(options.error().front());
    Error first;
    bool was_linear = false, was_rotary = false;
    for (const std::string& axis : axes_) {
      Campaign campaign;
      campaign.machine.axes.push_back({.name = axis, .rotary = axis[0] < 'D'});
      Measurement m;
      m.id = m.axis = axis;
      m.kind = "axis";
      m.file = name_;
      auto got = reading::checked_read(*reader, {bytes, campaign, m, *options, {}, nullptr});
      if (got) return Read{reader, axis, std::move(*got)};
      const Error& error = got.error();
      if (first.message.empty()) first = error;
      (campaign.machine.axes.front().rotary ? was_rotary : was_linear) = true;
      if (was_linear && was_rotary && error.line != 0 && error.line == first.line &&
          error.message == first.message)
        break;
    }
    return fail(std::move(first));
  }

  static Json points(const Read& read) {
    const Observations& o = read.readings;
    const Quantity at = position_of(o.axes.front().rotary), deviation = deviation_of(o.angular);
    const std::size_t step = (o.size() + most_points - 1) / most_points;
    Json position = Json::array(), value = Json::array(), run = Json::array(), way = Json::array();
    for (std::size_t i = 0; i < o.size(); i += std::max<std::size_t>(step, 1)) {
      position.push_back(printed(o.axes.front().position[i], at));
      value.push_back(printed(o.deviation[i], deviation));
      run.push_back(o.run[i]);
      way.push_back(o.axes.front().approach.empty() ? 0 : int{o.axes.front().approach[i]});
    }
    return {{"position_unit", std::string(unit_of(at).symbol)},
            {"deviation_unit", std::string(unit_of(deviation).symbol)},
            {"position", std::move(position)},
            {"deviation", std::move(value)},
            {"run", std::move(run)},
            {"direction", std::move(way)}};
  }

  int report(const Expected<Read>& read, const std::optional<reading::StatedTable>& table) const {
    if (!common_.json) {
      if (!read) return complain(printable(name_) + ": " + text_of(read.error()), exit_failed);
      if (!common_.quiet)
        std::cout << printable(name_) << ": reader " << read->reader->info.name << ", "
                  << read->readings.size() << " readings, " << read->readings.missing
                  << " not taken\n";
      return exit_done;
    }
    Json json = {{"schema", "nonio-check-file/1"}, {"file", name_}};
    if (read) {
      const Observations& o = read->readings;
      json["reader"] = read->reader->info.name;
      // X and A are only assumed axes; any other axis was stated by the file or by the caller.
      if (read->axis != "X" && read->axis != "A") json["axis"] = read->axis;
      json["rotary"] = o.axes.front().rotary;
      json["readings"] = o.size();
      json["missing"] = o.missing;
      json["points"] = points(*read);
      for (const Remark& note : o.notes)
        for (const auto& [name, words] : note.texts)
          if (name == "text") json["text"] = words;
    } else {
      json["error"] = {{"message", read.error().message}};
      if (read.error().line != 0) json["error"]["line"] = read.error().line;
      if (!read.error().column.empty()) json["error"]["column"] = read.error().column;
    }
    if (table) json["rows"] = table->rows;
    print_json(json);
    return read ? exit_done : exit_failed;
  }

  std::string name_;
  std::vector<std::string> axes_{"X", "A", "Y", "Z", "B", "C"};
  const std::vector<std::string>& columns_;
  const Common& common_;
  loader::Plugins plugins_{};
};

}  // namespace

int check_file(const fs::path& file, const FileWish& wish, const Common& common) {
  return FileCheck(file, wish, common).run(file);
}

}  // namespace nonio::app
