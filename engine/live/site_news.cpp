// SPDX-License-Identifier: Apache-2.0
#include "live/site_news.h"

#include <chrono>
#include <utility>

#include "batch/state/run_status.h"
#include "campaign/config/site_logs.h"
#include "certificates/certificate_list.h"
#include "certificates/register_place.h"
#include "live/campaign_index.h"

namespace nonio::live {
namespace fs = std::filesystem;

namespace {

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

}  // namespace

fs::path register_of(const fs::path& site) {
  const auto numbering = certificates::numbering_of(site);
  if (!numbering) return {};
  const auto place = certificates::register_place(site, *numbering);
  return place ? place->file : fs::path();
}

std::string worklist_stamp(const fs::path& site, const fs::path& out) {
  std::string stamp;
  for (const char* name :
       {config::events_name, config::acknowledged_name, config::forgotten_name, "site.toml"})
    stamp += file_stamp(site / name);
  return out.empty() ? stamp : stamp + file_stamp(out / "summary.json");
}

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
  out.worklist = worklist_stamp(site_, out_);
  if (!register_.empty())
    out.drafts = file_stamp(register_) + file_stamp(register_.string() + "-wal");
  return out;
}

void SiteNews::watch() {
  constexpr auto pause = std::chrono::seconds(1);
  tell_("worklist");
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
