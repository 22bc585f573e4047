// SPDX-License-Identifier: Apache-2.0
#include "status_metrics.h"

#include <chrono>
#include <map>

#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::app {

namespace {

/// Returns a label value with the quoting of OpenMetrics.
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

std::size_t length_of(const storage::Json& json, const char* list) {
  return json.contains(list) && json.at(list).is_array() ? json.at(list).size() : 0;
}

void put_lines(const storage::Json& summary, Metrics& metrics) {
  std::map<std::string, std::size_t> kinds;
  for (const char* kind : {"lost", "failed", "out", "changed", "soon", "overdue", "withheld",
                           "undecided", "information"})
    kinds[kind] = 0;
  if (summary.contains("lines"))
    for (const storage::Json& line : summary.at("lines"))
      if (line.value("state", "") != "fixed") ++kinds[line.value("kind", "other")];
  metrics.family("nonio_worklist_lines", "Lines of the worklist of the last run, by kind");
  for (const auto& [kind, count] : kinds) metrics.value(std::to_string(count), "kind", kind);
}

}  // namespace

Expected<std::string> metrics_of(const std::filesystem::path& out) {
  const auto path = out / "summary.json";
  NONIO_TRY(const auto text, storage::read_file(path));
  const storage::Json summary = storage::parse_or_discard(text);
  if (!summary.is_object() || !summary.contains("counts"))
    return fail(Error{"expected the summary of a run (JSON with counts)", path.string()});
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error);
  if (error) return fail(Error{error.message(), path.string()});
  using Seconds = std::chrono::duration<double>;
  const double age = Seconds(std::filesystem::file_time_type::clock::now() - written).count();
  const double now = Seconds(std::chrono::system_clock::now().time_since_epoch()).count();
  Metrics metrics;
  metrics.family("nonio_info", "Version of the program that made the last run");
  metrics.value("1", "version", summary.value("nonio", ""));
  metrics.family("nonio_last_run_timestamp_seconds", "When the last complete run ended");
  metrics.value(std::to_string(static_cast<long long>(now - age)));
  metrics.family("nonio_last_run_age_seconds", "Age of the last complete run");
  metrics.value(std::to_string(static_cast<long long>(age)));
  metrics.family("nonio_last_run_number", "Number of the last complete run");
  metrics.value(std::to_string(summary.value("night", 0LL)));
  metrics.family("nonio_campaigns", "Campaigns of the last run, by state");
  for (const auto& [state, count] : summary.at("counts").items())
    if (count.is_number()) metrics.value(count.dump(), "state", state);
  put_lines(summary, metrics);
  metrics.family("nonio_drafts_waiting", "Certificates that wait for an approval");
  metrics.value(std::to_string(length_of(summary, "drafts")));
  metrics.family("nonio_certificates_issued", "Certificates that the last run has seen issued");
  metrics.value(std::to_string(length_of(summary, "issued")));
  return metrics.made();
}

}  // namespace nonio::app
