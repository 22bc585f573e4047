// SPDX-License-Identifier: Apache-2.0
#include "batch/close/worklist_update.h"

#include <algorithm>
#include <set>

#include "batch/close/mail.h"
#include "batch/close/summary.h"
#include "batch/state/read_apart.h"
#include "campaign/evaluation/record.h"
#include "laboratory/assessment/assess.h"
#include "laboratory/assessment/curves.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_lines = 16;  // summary.txt fits on one page

bool is_as_it_was(const fs::path& path, const std::string& bytes) {
  std::error_code error;
  if (fs::file_size(path, error) != bytes.size() || error) return false;
  const auto found = storage::read_file(path);
  return found && *found == bytes;
}

bool is_in_a_list(const reports::WorkItem& line) {
  return line.kind == reports::WorkItem::Kind::lost || line.kind == reports::WorkItem::Kind::failed;
}

void remove_old_pages(const fs::path& folder, const std::set<std::string>& present) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().extension() == ".html" && !present.contains(at->path().filename().string())) {
      std::error_code ignored;
      fs::remove(at->path(), ignored);
    }
}

/// Reads the pages back from the disk. An error if they differ.
Expected<void> publish_checked(const fs::path& folder, const std::vector<Artifact>& pages) {
  if (pages.empty()) return {};
  if (auto put = storage::publish(folder, pages); !put) return put;
  for (const Artifact& page : pages) {
    storage::drop_cached(folder / page.name);
    if (!is_as_it_was(folder / page.name, page.bytes))
      return fail("the disk does not give back what was written to it: " +
                  (folder / page.name).string());
  }
  return {};
}

/// index.html is written last.
Expected<void> write_lists(const fs::path& out, std::vector<Artifact> pages) {
  std::reverse(pages.begin(), pages.end());
  std::erase_if(pages, [&](const Artifact& p) { return is_as_it_was(out / p.name, p.bytes); });
  return publish_checked(out, pages);
}

/// Pages of the site are written last, because they link to those of the machines.
Expected<void> write_pages(const fs::path& out, std::vector<Artifact> pages) {
  std::vector<Artifact> root, machines;
  std::set<std::string> present;
  for (Artifact& page : pages) {
    if (!page.name.starts_with(std::string(reports::machines_folder) + "/")) {
      root.push_back(std::move(page));
      continue;
    }
    std::string name = page.name.substr(page.name.find('/') + 1);
    present.insert(name);
    if (is_as_it_was(out / page.name, page.bytes)) continue;
    machines.push_back({std::move(name), std::move(page.bytes)});
  }
  if (auto put = publish_checked(out / reports::machines_folder, machines); !put) return put;
  remove_old_pages(out / reports::machines_folder, present);
  return write_lists(out, std::move(root));
}

/// Result of the child process: text, json, asking, judged ("1" or empty), mail, actions.
using Texts = std::vector<std::string>;

void add_curves(reports::SiteHistory& site, const fs::path& out,
                const std::function<void()>& alive) {
  for (reports::MachineHistory& machine : site.machines) {
    alive();
    machine.curves = assessment::curves_of(out, machine);
  }
}

/// Returns an empty text without [mail] or if no line is severe enough. Restores `site`.
Expected<std::string> mail_text(reports::SiteHistory& site, const reading::Context& context,
                                const std::string& language) {
  if (!context.site.mail) return std::string();
  std::vector<reports::WorkItem> all = site.lines;
  std::erase_if(site.lines, [&](const reports::WorkItem& line) {
    return !is_reason_for_mail(line, context.site.mail->on);
  });
  if (std::string base = context.site.mail->base_url; !base.empty()) {
    if (!base.ends_with('/')) base += '/';
    for (reports::WorkItem& line : site.lines)
      if (!line.link.empty()) line.link = base + line.link;
  }
  auto text = site.lines.empty()
                  ? Expected<std::string>()
                  : reports::worklist_text(site, context.templates, language, site.lines.size());
  site.lines = std::move(all);
  return text;
}

std::string language_of_pages(const reading::Context& context) {
  const std::string& own = context.site.language;
  return context.templates.tables.contains("words/" + own + "/site") ? own : "en";
}

Expected<Texts> texts_of(reports::SiteHistory site, const reading::Context& context) {
  const std::string language = language_of_pages(context);
  const std::string json = assessment::lines_json(site, context.templates);
  const auto asking = std::count_if(site.lines.begin(), site.lines.end(), reports::asks);
  NONIO_TRY(const auto mail, mail_text(site, context, language));
  reports::SiteHistory action;
  std::copy_if(site.lines.begin(), site.lines.end(), std::back_inserter(action.lines),
               reports::asks);
  const std::string actions = assessment::lines_json(action, context.templates, language);
  std::erase_if(site.lines, is_in_a_list);
  NONIO_TRY(auto text, site.lines.empty()
                           ? Expected<std::string>()
                           : reports::worklist_text(site, context.templates, language, most_lines));
  return Texts{std::move(text),        json, std::to_string(asking),
               site.judged ? "1" : "", mail, actions};
}

Expected<Texts> small_worklist(const fs::path& out, const reading::Context& context,
                               const assessment::LastRun& last_run,
                               const std::function<void()>& alive) {
  NONIO_TRY(auto site, assessment::assess(out, last_run, alive, assessment::Keep::trends));
  add_curves(site, out, alive);
  NONIO_TRY(auto pages, reports::site_pages(site, context.templates, language_of_pages(context)));
  alive();
  if (auto written = write_pages(out, std::move(pages)); !written) return fail(written.error());
  return texts_of(std::move(site), context);
}

/// Writes only pages of machines with new data, unless the language or the templates have changed.
class MachinePages {
 public:
  MachinePages(assessment::Assessment& assessment, const fs::path& out,
               const reading::Context& context)
      : assessment_(assessment),
        out_(out),
        context_(context),
        language_(language_of_pages(context)),
        made_from_(context.template_texts.sha256 + language_) {}

  Expected<void> write(const std::function<void()>& alive) {
    constexpr std::size_t at_once = 64;
    std::set<std::string> present;
    const auto& machines = assessment_.site().machines;
    for (std::size_t i = 0; i < machines.size(); ++i) {
      alive();
      present.insert(machines[i].file);
      if (assessment_.has_page(i, made_from_)) continue;
      NONIO_TRY(const auto machine, assessment_.whole(i));
      auto page =
          reports::machine_page_of(assessment_.site(), machine, context_.templates, language_);
      if (!page) return fail(page.error());
      which_.push_back(i);
      if (!is_as_it_was(out_ / page->name, page->bytes))
        pages_.push_back({machines[i].file, std::move(page->bytes)});
      if (which_.size() == at_once)
        if (auto put = publish(); !put) return put;
    }
    if (auto put = publish(); !put) return put;
    remove_old_pages(out_ / reports::machines_folder, present);
    return {};
  }

 private:
  Expected<void> publish() {
    if (auto put = publish_checked(out_ / reports::machines_folder, pages_); !put) return put;
    for (const std::size_t i : which_) assessment_.note_page(i, made_from_);
    pages_.clear(), which_.clear();
    return {};
  }

  assessment::Assessment& assessment_;
  const fs::path& out_;
  const reading::Context& context_;
  const std::string language_, made_from_;
  std::vector<Artifact> pages_{};
  std::vector<std::size_t> which_{};
};

Expected<Texts> large_worklist(const fs::path& out, const reading::Context& context,
                               const assessment::LastRun& last_run,
                               const std::function<void()>& alive) {
  auto assessment =
      assessment::Assessment::of(out, last_run, alive, assessment::Assessment::Kept::used);
  if (!assessment) return fail(assessment.error());
  MachinePages pages(*assessment, out, context);
  if (auto written = pages.write(alive); !written) return fail(written.error());
  auto lists =
      reports::site_lists(assessment->site(), context.templates, language_of_pages(context));
  if (!lists) return fail(lists.error());
  alive();
  if (auto written = write_lists(out, std::move(*lists)); !written) return fail(written.error());
  assessment->keep();
  alive();
  return texts_of(std::move(*assessment).take_site(), context);
}

}  // namespace

assessment::LastRun last_run_of(const RunResult& run, const fs::path& out,
                                const Templates& templates) {
  const config::TerminalWords english(templates, "en");
  assessment::LastRun last_run;
  last_run.run = run.run.number, last_run.date = run.run.date;
  last_run.campaigns = run.campaigns.size();
  for (const CampaignState& c : run.campaigns) {
    if (c.status == evaluation::Status::failed) {
      assessment::LastRun::Failed failed{c.id, c.folder, first_error(c, english), {}};
      const auto record = evaluation::read_record(storage::results_folder(out, c.id));
      if (record && record->failed_since && record->failed_since->number < last_run.run)
        failed.since = record->failed_since->date;
      last_run.failed.push_back(std::move(failed));
    } else {
      ++(c.action == CampaignState::Action::done ? last_run.done : last_run.unchanged);
    }
  }
  for (const Vanished& v : run.vanished)
    last_run.vanished.push_back({v.id, v.folder, v.run, v.why});
  for (const auto& entry : run.issued) last_run.issued.push_back(entry.number);
  for (const auto& draft : run.waiting) last_run.waiting.push_back(draft.campaign);
  last_run.out_of_force = run.out_of_force;
  last_run.history_error = run.history_error;
  return last_run;
}

Expected<WorklistPages> make_worklist(const RunOptions& options, const reading::Context& context,
                                      const assessment::LastRun& last_run,
                                      std::uint64_t most_curves) {
  const auto made = read_apart<Texts>(
      "the history of the machines", context.site.limits.disk_seconds,
      [&](process::SignsOfLife& signs) -> Expected<Texts> {
        signs.reading(options.out.string());
        const auto alive = [&] { signs.beat(); };
        const auto make = last_run.campaigns > most_curves ? large_worklist : small_worklist;
        return make(options.out, context, last_run, alive);
      });
  if (!made) return fail(made.error());
  return WorklistPages{(*made)[0],          (*made)[1], std::stoull((*made)[2]),
                       !(*made)[3].empty(), (*made)[5], (*made)[4]};
}

}  // namespace nonio::batch
