// SPDX-License-Identifier: Apache-2.0
#include "live/campaign_form.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

#include "campaign/config/keys.h"
#include "campaign/config/manifest.h"
#include "certificates/users.h"
#include "live/audit_log.h"
#include "nonio/sdk/text.h"
#include "platform/storage/files.h"

namespace nonio::live {
using storage::Json;

namespace {

enum class Form { text, day, number };

struct Field {
  const char* key;
  Form form = Form::text;
  const char* option = nullptr;
};

constexpr Field fields[] = {{"campaign.date", Form::day, "date"},
                            {"campaign.customer", Form::text, "customer"},
                            {"campaign.customer_address"},
                            {"campaign.site"},
                            {"campaign.operator", Form::text, "operator"},
                            {"machine.asset", Form::text, "asset"},
                            {"machine.maker", Form::text, "maker"},
                            {"machine.model", Form::text, "machine"},
                            {"machine.serial", Form::text, "serial"},
                            {"machine.control", Form::text, "control"},
                            {"instrument.model", Form::text, "instrument"},
                            {"instrument.maker"},
                            {"instrument.serial"},
                            {"instrument.calibrated", Form::day},
                            {"instrument.certificate"},
                            {"instrument.U_fixed_um", Form::number},
                            {"instrument.U_per_m_um", Form::number},
                            {"environment.misalignment_mm", Form::number},
                            {"environment.temperature_range_K", Form::number},
                            {"environment.temperature_difference_K", Form::number},
                            {"environment.expansion_range_um_per_m_K", Form::number},
                            {"environment.drift_um", Form::number},
                            {"certificate.conditions"}};

constexpr std::size_t longest_value_of_form = 500, longest_file_name = 120;

bool is_one_line(const std::string& text) {
  return text.size() <= longest_value_of_form && is_utf8(text) &&
         std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

bool is_number(std::string& text) {
  std::replace(text.begin(), text.end(), ',', '.');
  if (text.starts_with('+')) text.erase(0, 1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return false;
  std::array<char, 32> as_written_in_toml{};
  const auto written = std::to_chars(as_written_in_toml.begin(), as_written_in_toml.end(), value);
  text.assign(as_written_in_toml.begin(), written.ptr);
  return true;
}

bool is_taken_name(std::string name) {
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  constexpr std::string_view own[] = {config::manifest_name, "model-history.jsonl",
                                      "machine-record.json", certificates::users_name, audit_name};
  const auto is_name = [&](std::string_view one) { return one == name; };
  if (std::any_of(std::begin(own), std::end(own), is_name) ||
      std::any_of(std::begin(config::reserved_names), std::end(config::reserved_names), is_name))
    return true;
  const std::string stem = name.substr(0, name.find('.'));
  const bool numbered = stem.size() == 4 && (stem.starts_with("com") || stem.starts_with("lpt")) &&
                        stem[3] >= '0' && stem[3] <= '9';
  return numbered || stem == "con" || stem == "prn" || stem == "aux" || stem == "nul";
}

bool is_date(const std::string& text) {
  const std::string_view form = "0000-00-00";
  return std::equal(text.begin(), text.end(), form.begin(), form.end(),
                    [](char c, char f) { return f == '0' ? c >= '0' && c <= '9' : c == f; });
}

bool has_form(Form form, std::string& text) {
  switch (form) {
    case Form::day:
      return is_date(text);
    case Form::number:
      return is_number(text);
    case Form::text:
      break;
  }
  return is_one_line(text);
}

std::string text_of(const Json& json, const std::string& name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

const Json& values_of(const Json& form) {
  static const Json none = Json::object();
  const auto found = form.find("values");
  return found != form.end() && found->is_object() ? *found : none;
}

bool is_axis(const std::string& name) {
  return !name.empty() && name.size() <= 4 && name[0] >= 'A' && name[0] <= 'Z' &&
         std::all_of(name.begin() + 1, name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

class FormOptions {
 public:
  explicit FormOptions(const Json& form)
      : form_(form), values_(values_of(form)), axis_(text_of(form, "axis")) {}

  tl::expected<std::vector<std::string>, Answer> all() {
    if (!is_axis(axis_)) refuse("axis");
    if (text_of(values_, "campaign.date").empty()) refuse("campaign.date");
    for (const Field& field : fields) {
      std::string text = text_of(values_, field.key);
      if (text.empty()) continue;
      if (!has_form(field.form, text)) refuse(field.key);
      out_.push_back(field.option != nullptr ? "--" + std::string(field.option) + "=" + text
                                             : "--set=" + std::string(field.key) + "=" + text);
    }
    put_axis();
    return result();
  }

  tl::expected<std::vector<std::string>, Answer> columns() {
    const auto found = form_.find("columns");
    constexpr std::size_t most = 100;
    if (found == form_.end()) return result();
    if (!found->is_array() || found->size() > most) refuse("columns");
    for (const Json& one : *found) {
      if (!one.is_string() || !is_one_line(one.get<std::string>())) {
        refuse("columns");
        break;
      }
      out_.push_back("--column=" + one.get<std::string>());
    }
    return result();
  }

 private:
  void refuse(const std::string& key) {
    if (wrong_) return;
    wrong_ = refused(422, "form_value");
    wrong_->body = storage::dump_line({{"key", key}});
  }
  tl::expected<std::vector<std::string>, Answer> result() {
    if (wrong_) return tl::unexpected(*wrong_);
    return std::move(out_);
  }
  std::string number(const std::string& key) {
    std::string text = text_of(values_, key);
    if (!text.empty() && !is_number(text)) refuse(key);
    return text;
  }
  void put_axis() {
    // The letters A to C denote rotary axes, as on the command line.
    const bool rotary = !axis_.empty() && axis_[0] >= 'A' && axis_[0] <= 'C';
    const std::string table = "--set=machine.axes." + axis_ + ".";
    const std::string from = number("axis.from"), to = number("axis.to");
    if (from.empty() != to.empty()) refuse(from.empty() ? "axis.from" : "axis.to");
    if (!from.empty()) out_.push_back("--axis=" + axis_ + "=" + from + ":" + to);
    std::string limits;
    for (const std::string name : {"A", "B", "E", "R"})
      if (const std::string limit = number("axis.tolerance." + name); !limit.empty())
        limits += (limits.empty() ? " " : ", ") + name + " = " + limit;
    if (!limits.empty())
      out_.push_back(table + (rotary ? "tolerance_arcsec={" : "tolerance_um={") + limits + " }");
    const std::string expansion = number("axis.expansion_um_per_m_K");
    if (!expansion.empty() && !rotary) out_.push_back(table + "expansion_um_per_m_K=" + expansion);
    if (text_of(values_, "axis.compensation") != "none") return;
    out_.push_back(table + "active_table=none");
    out_.push_back(table + (rotary ? "active_backlash_deg=none" : "active_backlash_mm=none"));
  }

  const Json &form_, &values_;
  std::string axis_;
  std::vector<std::string> out_{};
  std::optional<Answer> wrong_{};
};

}  // namespace

tl::expected<DroppedFile, Answer> dropped_file(const std::string& body) {
  const std::size_t end = body.find('\n');
  DroppedFile out;
  if (end != body.npos) out.form = storage::parse_once(std::string_view(body).substr(0, end));
  if (!out.form.is_object()) return tl::unexpected(refused(400, "no_object"));
  out.name = text_of(out.form, "name");
  constexpr std::string_view not_on_windows = "\\/:*?\"<>|";
  const bool plain = storage::is_artifact_name(out.name) && is_one_line(out.name) &&
                     out.name.size() <= longest_file_name && !is_taken_name(out.name) &&
                     out.name.find_first_of(not_on_windows) == out.name.npos &&
                     out.name.back() != '.' && out.name.back() != ' ';
  if (!plain) return tl::unexpected(refused(422, "file_name"));
  out.bytes = body.substr(end + 1);
  if (out.bytes.empty()) return tl::unexpected(refused(422, "file_empty"));
  return out;
}

tl::expected<std::vector<std::string>, Answer> file_options(const Json& form) {
  auto out = FormOptions(form).columns();
  const std::string axis = text_of(form, "axis");
  if (out && is_axis(axis)) out->push_back("--axis=" + axis);
  return out;
}

tl::expected<std::vector<std::string>, Answer> campaign_options(const Json& form) {
  auto out = FormOptions(form).all();
  const auto columns = FormOptions(form).columns();
  if (!columns) return columns;
  if (out) out->insert(out->end(), columns->begin(), columns->end());
  return out;
}

std::string proposed_id(const Json& form) {
  const Json& values = values_of(form);
  std::string machine = text_of(values, "machine.asset");
  for (const char* key : {"machine.serial", "machine.model", "machine.maker"})
    if (machine.empty()) machine = text_of(values, key);
  std::string out;
  constexpr std::size_t most = 80;
  for (const char c :
       text_of(values, "campaign.date") + "-" + machine + "-" + text_of(form, "axis")) {
    const char low = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    const bool may = (low >= 'a' && low <= 'z') || (low >= '0' && low <= '9');
    if (may)
      out += low;
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  out.resize(std::min(out.size(), most));
  while (!out.empty() && out.back() == '-') out.pop_back();
  // The prefix avoids names of folders of the site, such as "machines", and device names of
  // Windows, such as "con".
  return out.empty() || out[0] < '0' || out[0] > '9' ? "campaign-" + out : out;
}

}  // namespace nonio::live
