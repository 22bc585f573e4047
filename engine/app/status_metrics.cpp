// SPDX-License-Identifier: Apache-2.0
#include "status_metrics.h"

#include <simdjson.h>

#include <chrono>
#include <ctime>
#include <map>

#include "batch/state/run_status.h"
#include "certificates/certificate_list.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"

namespace nonio::app {
namespace dom = simdjson::dom;

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + "\"";
}

class Metrics {
 public:
  void family(const std::string& name, const std::string& help) {
    name_ = name;
    out_ += "# TYPE " + name + " gauge\n# HELP " + name + " " + help + "\n";
  }
  void value(const std::string& number, const std::string& label = "", const std::string& of = "") {
    out_ +=
        name_ + (label.empty() ? "" : "{" + label + "=" + quoted(of) + "}") + " " + number + "\n";
  }
  std::string made() { return out_ + "# EOF\n"; }

 private:
  std::string out_, name_;
};

std::size_t length_of(const dom::object& json, const char* list) {
  dom::array all;
  return json[list].get(all) == simdjson::SUCCESS ? all.size() : 0;
}

std::string text_in(const dom::object& json, const char* key, std::string_view otherwise = "") {
  std::string_view text;
  return std::string(json[key].get(text) == simdjson::SUCCESS ? text : otherwise);
}

void put_lines(const dom::object& summary, Metrics& metrics) {
  std::map<std::string, std::size_t> kinds;
  for (const char* kind : {"lost", "failed", "out", "changed", "soon", "overdue", "withheld",
                           "undecided", "information"})
    kinds[kind] = 0;
  dom::array lines;
  if (summary["lines"].get(lines) == simdjson::SUCCESS)
    for (const dom::object line : lines)
      if (text_in(line, "state") == "new") ++kinds[text_in(line, "kind", "other")];
  metrics.family("nonio_worklist_lines",
                 "Lines of the worklist of the last run that are not acknowledged, by kind");
  for (const auto& [kind, count] : kinds) metrics.value(std::to_string(count), "kind", kind);
}

void put_due(const std::filesystem::path& out, Metrics& metrics) {
  using namespace std::chrono;
  const auto file = storage::read_file(out / "due.ics");
  if (!file) return;
  const std::time_t now_s = system_clock::to_time_t(system_clock::now());
  std::tm local{};  // days of a site are local
  ::localtime_r(&now_s, &local);
  const sys_days today = year(local.tm_year + 1900) / (local.tm_mon + 1) / local.tm_mday;
  const auto text_of_day = [](sys_days at) {
    const year_month_day day(at);
    return std::to_string(int(day.year()) * 10000 + unsigned(day.month()) * 100 +
                          unsigned(day.day()));
  };
  const std::string now = text_of_day(today), soon = text_of_day(today + days(30));
  std::size_t overdue = 0, near = 0;
  constexpr std::string_view key = "DTSTART;VALUE=DATE:";
  for (std::size_t at = file->find(key); at != std::string::npos; at = file->find(key, at + 1)) {
    const std::string day = file->substr(at + key.size(), now.size());
    ++(day < now ? overdue : near);
    if (day > soon) --near;
  }
  metrics.family("nonio_certificates_due",
                 "Machines whose next calibration is overdue, or due within 30 days");
  metrics.value(std::to_string(overdue), "within", "overdue");
  metrics.value(std::to_string(near), "within", "30_days");
}

}  // namespace

Expected<std::string> metrics_of(const std::filesystem::path& out, const std::string& site) {
  const auto path = out / "summary.json";
  NONIO_TRY(const auto text, storage::read_file(path));
  // simdjson is used because the summary of 100,000 campaigns can have 100 MB.
  dom::parser parser;
  dom::object summary, counts;
  if (parser.parse(text).get(summary) != simdjson::SUCCESS ||
      summary["counts"].get(counts) != simdjson::SUCCESS)
    return fail(Error{"expected the summary of a run (JSON with counts)", path.string()});
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error);
  if (error) return fail(Error{error.message(), path.string()});
  using Seconds = std::chrono::duration<double>;
  const double age = Seconds(std::filesystem::file_time_type::clock::now() - written).count();
  const double now = Seconds(std::chrono::system_clock::now().time_since_epoch()).count();
  Metrics metrics;
  metrics.family("nonio_info", "Version of the program that made the last run");
  metrics.value("1", "version", text_in(summary, "nonio"));
  metrics.family("nonio_last_run_timestamp_seconds", "When the last complete run ended");
  metrics.value(std::to_string(static_cast<long long>(now - age)));
  metrics.family("nonio_last_run_age_seconds", "Age of the last complete run");
  metrics.value(std::to_string(static_cast<long long>(age)));
  metrics.family("nonio_last_run_number", "Number of the last complete run");
  std::int64_t number = 0;
  [[maybe_unused]] const auto stated = summary["night"].get(number);
  metrics.value(std::to_string(number));
  if (const auto status = batch::run_status(out); status && status->seconds) {
    metrics.family("nonio_last_run_seconds", "Duration of the last complete run");
    metrics.value(fixed_text(*status->seconds, 3));
  }
  metrics.family("nonio_campaigns", "Campaigns of the last run, by state");
  for (const auto& count : counts)
    if (std::int64_t n = 0; count.value.get(n) == simdjson::SUCCESS)
      metrics.value(std::to_string(n), "state", std::string(count.key));
  put_lines(summary, metrics);
  metrics.family("nonio_drafts_waiting", "Certificates that wait for an approval");
  std::size_t waiting = length_of(summary, "drafts");
  if (!site.empty()) {
    NONIO_TRY(const auto drafts, certificates::waiting_campaigns(site));
    waiting = drafts.size();
  }
  metrics.value(std::to_string(waiting));
  metrics.family("nonio_certificates_issued", "Certificates that the last run has seen issued");
  metrics.value(std::to_string(length_of(summary, "issued")));
  put_due(out, metrics);
  return metrics.made();
}

}  // namespace nonio::app
