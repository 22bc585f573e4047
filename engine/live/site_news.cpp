// SPDX-License-Identifier: Apache-2.0
#include "live/site_news.h"

#include <sys/stat.h>

#include <chrono>
#include <utility>

#include "batch/state/run_status.h"
#include "campaign/config/site_logs.h"
#include "certificates/certificate_list.h"
#include "certificates/register_place.h"

namespace nonio::live {
namespace fs = std::filesystem;

namespace {

/// Returns a text that changes when the file is written or replaced; "-" if it does not exist.
std::string news_stamp(const fs::path& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return "-";
  return std::to_string(s.st_size) + " " + std::to_string(s.st_mtim.tv_sec) + " " +
         std::to_string(s.st_mtim.tv_nsec) + " " + std::to_string(s.st_ino) + ";";
}

RunNow run_now(const fs::path& out) {
  if (out.empty()) return {.state = "none"};
  const auto status = batch::run_status(out);
  if (!status) return {.state = "none"};
  RunNow now{.state = batch::to_text(status->state),
             .number = status->run.number,
             .date = status->run.date};
  if (status->last) now.last = status->last->run.number, now.last_date = status->last->run.date;
  return now;
}

fs::path register_of(const fs::path& site) {
  const auto numbering = certificates::numbering_of(site);
  if (!numbering) return {};
  const auto place = certificates::register_place(site, *numbering);
  return place ? place->file : fs::path();
}

}  // namespace

SiteNews::SiteNews(fs::path site, fs::path out, Tell tell)
    : site_(std::move(site)),
      out_(std::move(out)),
      register_(register_of(site_)),
      tell_(std::move(tell)),
      seen_(look()) {
  thread_ = std::thread([this] { watch(); });
}

SiteNews::~SiteNews() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

RunNow SiteNews::run() const {
  const std::lock_guard lock(mutex_);
  return seen_.run;
}

void SiteNews::look_now() {
  {
    const std::lock_guard lock(mutex_);
    now_ = true;
  }
  wake_.notify_all();
}

SiteNews::Seen SiteNews::look() const {
  Seen out;
  out.run = run_now(out_);
  for (const char* name :
       {config::events_name, config::acknowledged_name, config::forgotten_name, "site.toml"})
    out.worklist += news_stamp(site_ / name);
  if (!out_.empty()) out.worklist += news_stamp(out_ / "summary.json");
  if (!register_.empty())
    out.drafts = news_stamp(register_) + news_stamp(register_.string() + "-wal");
  return out;
}

void SiteNews::watch() {
  constexpr auto pause = std::chrono::seconds(1);
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, pause, [&] { return over_ || now_; });
      if (over_) return;
      now_ = false;
    }
    Seen now = look();
    Seen before;
    {
      const std::lock_guard lock(mutex_);
      before = std::exchange(seen_, now);
    }
    if (!(now.run == before.run)) tell_("run");
    if (now.worklist != before.worklist) tell_("worklist");
    if (now.drafts != before.drafts) tell_("drafts");
  }
}

}  // namespace nonio::live
