// SPDX-License-Identifier: Apache-2.0
#include "live/site_run.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"

namespace nonio::live {
using storage::Json;

ResultsNow results_now(const std::filesystem::path& out, const std::string& id) {
  if (id.empty()) return {};
  const auto record = evaluation::read_record(storage::results_folder(out, id));
  if (!record) return {};
  ResultsNow now{.status = evaluation::to_text(record->status), .sha256 = {}, .findings = {}};
  for (const evaluation::RecordedFile& file : record->files)
    if (file.name == evaluation::results_name) now.sha256 = file.sha256;
  for (const evaluation::KnownFinding& f : record->findings)
    if (f.attention)
      now.findings.push_back((f.measurement.empty() ? "" : f.measurement + ": ") + f.heading());
  return now;
}

namespace {

/// Ends only a run that hangs, because each campaign has its own limit.
constexpr double longest_run_s = 24.0 * 3600.0;

Json only_in(const std::vector<std::string>& all, const std::vector<std::string>& other) {
  Json out = Json::array();
  for (const std::string& one : all)
    if (std::find(other.begin(), other.end(), one) == other.end()) out.push_back(one);
  return out;
}

}  // namespace

SiteRun::SiteRun(Launcher& launcher, std::filesystem::path out, std::function<void()> changed)
    : launcher_(launcher), out_(std::move(out)), changed_(std::move(changed)) {}

SiteRun::~SiteRun() {
  close();
  if (thread_.joinable()) thread_.join();
}

Expected<bool> SiteRun::begin(const std::vector<std::string>& arguments, const std::string& command,
                              const std::string& id) {
  std::unique_lock lock(mutex_);
  if (running_ || over_) return false;
  NONIO_TRY(auto channel, launcher_.run(arguments, longest_run_s));
  if (thread_.joinable()) thread_.join();
  running_ = true;
  cancelled_ = false;
  id_ = id;
  before_ = results_now(out_, id);
  channel_ = channel.get();
  last_words_.clear();
  now_ = {{"state", "running"}, {"campaign", id}, {"command", command},
          {"stage", "begin"},   {"done", 0},      {"to_do", 0}};
  thread_ = std::thread([this, from = channel.release()] { follow(process::Handle(from)); });
  return true;
}

bool SiteRun::cancel() {
  const std::lock_guard lock(mutex_);
  if (!running_) return false;
  cancelled_ = true;
  const int fd = ::dup(channel_);
  if (fd < 0) return false;
  stop_tool(process::Handle(fd));
  return true;
}

bool SiteRun::is_running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

Json SiteRun::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void SiteRun::close() {
  const std::lock_guard lock(mutex_);
  over_ = true;
  // The next run resumes an interrupted run.
  if (channel_ >= 0) ::shutdown(channel_, SHUT_RDWR);
}

void SiteRun::take(const std::string& line) {
  const Json event = storage::parse_or_discard(line);
  {
    const std::lock_guard lock(mutex_);
    if (!event.is_object() || !event.contains("event")) {
      last_words_ = line;
      return;
    }
    const std::string what = event.value("event", "");
    if (what == "stage") now_["stage"] = event.value("name", "");
    if (what == "planned") now_["to_do"] = event.value("to_do", 0);
    if (what == "campaign") {
      now_["done"] = event.value("done", 0);
      if (event.contains("message")) now_["message"] = event["message"];
    }
    if (what == "end") now_["counts"] = event;
  }
  changed_();
}

void SiteRun::end(const ToolEnd& end) {
  constexpr int interrupted = 130, refused = 2;
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    channel_ = -1;
    now_["exit_status"] = end.status;
    const bool stopped = end.status == interrupted || end.status < 0;
    now_["state"] = stopped ? "cancelled" : end.status == refused ? "refused" : "done";
    if (end.status == refused || (stopped && !cancelled_)) now_["message"] = last_words_;
    if (!id_.empty() && !stopped && end.status != refused) {
      const ResultsNow after = results_now(out_, id_);
      now_["status"] = after.status;
      now_["was"] = before_.status;
      now_["same_results"] = !after.sha256.empty() && after.sha256 == before_.sha256;
      now_["new_findings"] = only_in(after.findings, before_.findings);
      now_["gone_findings"] = only_in(before_.findings, after.findings);
    }
  }
  changed_();
}

void SiteRun::follow(process::Handle channel) {
  const ToolEnd end_of_tool = hear_tool(channel, [this](const std::string& line) { take(line); });
  end(end_of_tool);
}

}  // namespace nonio::live
