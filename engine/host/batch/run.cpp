// SPDX-License-Identifier: Apache-2.0
#include "host/batch/run.h"

#include <algorithm>
#include <array>
#include <memory>
#include <new>

#include "host/batch/history_update.h"
#include "host/batch/mail.h"
#include "host/batch/morning_update.h"
#include "host/batch/night_state.h"
#include "host/batch/read_apart.h"
#include "host/batch/runner.h"
#include "host/batch/set_up.h"
#include "host/batch/store.h"
#include "host/batch/summary.h"
#include "host/batch/survey.h"
#include "host/storage/database.h"
#include "host/storage/disk.h"
#include "host/storage/files.h"

namespace nonio::host::batch {
namespace fs = std::filesystem;

namespace {

using Action = CampaignState::Action;

/// Results are never written among the files of a campaign, which they could replace.
std::string unfit_output(const fs::path& site, const fs::path& out) {
  std::error_code error;
  const fs::path root = fs::weakly_canonical(site, error);
  fs::path folder = fs::weakly_canonical(out, error);
  if (folder == root) return "the output folder is the site itself; expected another folder";
  for (; folder != folder.parent_path(); folder = folder.parent_path())
    if (fs::exists(folder / config::manifest_name, error))
      return "the output folder lies in the campaign " + folder.string() +
             "; expected another folder";
  return {};
}

/// What the survey has failed: a good result of a night before stays, else there is one that says
/// what is wrong. Several campaigns with one id claim one folder.
void store_refused(const RunOptions& options, const reading::Context& context,
                   const NightState& night, const RunEvents& events,
                   std::vector<CampaignState>& campaigns) {
  const storage::Disk disk(options.out);
  const CampaignState* before = nullptr;
  for (CampaignState& c : campaigns) {
    if (c.action != Action::todo || c.status != evaluation::Status::failed) continue;
    const auto record = evaluation::read_record(storage::results_folder(options.out, c.id));
    const bool stays = c.is_campaign && record && record->status != evaluation::Status::failed;
    if (stays)
      c.errors.front().message +=
          "; the results of night " + std::to_string(record->night) + " stay as they are";
    if (c.is_campaign && !stays && (before == nullptr || before->id != c.id)) {
      evaluation::Evaluated evaluated;
      evaluated.campaign.id = c.id;
      evaluated.status = evaluation::Status::failed;
      evaluated.results.errors = c.errors;
      if (const auto stored =
              store(options.out, evaluated, context, {c.folder, night.of(), c.reason, true}, disk);
          !stored)
        c.errors.push_back(stored.error());
    }
    before = &c;
    c.action = Action::done;
    events.finished(c);
  }
}

/// The first look at the site: the name by which the night's record knows it.
Expected<std::string> look_at_site(const RunOptions& options) {
  const fs::path& site = options.site;
  return read_apart<std::string>("the site " + site.string(), config::Limits{}.disk_seconds,
                                 [&](process::SignsOfLife& signs) -> Expected<std::string> {
                                   signs.reading(site.string());
                                   std::error_code error;
                                   if (!fs::is_directory(site, error))
                                     return fail("there is no site folder " + site.string());
                                   if (std::string why = unfit_output(site, options.out);
                                       !why.empty())
                                     return fail(std::move(why));
                                   return fs::weakly_canonical(site, error).string();
                                 });
}

/// A register in an output folder below the site would be lost with it.
Expected<void> check_register_place(const RunOptions& options, const reading::Context& context) {
  const auto path = certificates::register_path(options.site, context.site.numbering);
  if (!path) return fail(path.error());
  std::error_code error;
  const auto is_below = [](const fs::path& one, const fs::path& folder) {
    const fs::path way = one.lexically_relative(folder);
    return !way.empty() && *way.begin() != "..";
  };
  const fs::path out = fs::weakly_canonical(options.out, error);
  if (is_below(*path, out) && is_below(out, fs::weakly_canonical(options.site, error)))
    return fail("the register of certificates " + path->string() +
                " would lie in the output folder; expected it elsewhere in the site");
  return {};
}

/// What the register says before the night; nothing if another process keeps it locked.
struct Known {
  std::vector<certificates::RegisterEntry> numbers;
  std::vector<certificates::WaitingDraft> drafts;
};

Expected<std::optional<Known>> known_of(const RunOptions& options,
                                        const reading::Context& context) {
  const config::Numbering& numbering = context.site.numbering;
  const double patience = std::min(5.0, numbering.patience);
  auto known = read_apart<
      std::pair<std::vector<certificates::RegisterEntry>, std::vector<certificates::WaitingDraft>>>(
      "the register of certificates", context.site.limits.disk_seconds + patience,
      [&](process::SignsOfLife& signs)
          -> Expected<std::pair<std::vector<certificates::RegisterEntry>,
                                std::vector<certificates::WaitingDraft>>> {
        signs.reading((options.site / numbering.register_file).string());
        if (const auto sound = check_register_place(options, context); !sound)
          return fail(sound.error());
        auto numbers = certificates::Register::entries(options.site, numbering, patience);
        if (!numbers) return fail(numbers.error());
        signs.beat();
        auto drafts = certificates::Register::drafts(options.site, numbering, patience);
        if (!drafts) return fail(drafts.error());
        return std::pair(std::move(*numbers), std::move(*drafts));
      });
  if (!known && storage::is_locked(known.error())) return std::nullopt;
  if (!known) return fail(known.error());
  return Known{std::move(known->first), std::move(known->second)};
}

std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers) {
  std::uint64_t last = 0;
  for (const certificates::RegisterEntry& e : numbers) last = std::max(last, e.order);
  return last;
}

/// What is new, in the order of the numbers, and what waits. An error if the register cannot be
/// read: a summary without what was issued would pass for one of a night that issued nothing.
Expected<void> note_certificates(Night& night, const RunOptions& options,
                                 const reading::Context& context, NightState& state) {
  auto known = known_of(options, context);
  if (!known) return fail(known.error());
  if (!*known) {  // the next night lists it
    night.notes.push_back("the register of certificates is locked: what was issued is not listed");
    return {};
  }
  const std::uint64_t before = state.issued_before.value_or(0);
  state.issued_at_begin = before;
  state.issued_before = issued_so_far((*known)->numbers);
  for (certificates::RegisterEntry& e : (*known)->numbers)
    if (e.order > before) night.issued.push_back(std::move(e));
  for (certificates::WaitingDraft& draft : (*known)->drafts) {
    const auto here = std::find_if(night.campaigns.begin(), night.campaigns.end(),
                                   [&](const CampaignState& c) { return c.id == draft.campaign; });
    if (here != night.campaigns.end() && here->status != evaluation::Status::failed)
      night.waiting.push_back(std::move(draft));
  }
  return {};
}

void tidy_root(const fs::path& out) {
  storage::remove_leftovers(out);
  storage::remove_leftovers(out / state_folder);
}

/// The folders of results in an output folder, whatever their layout.
Expected<void> tidy_below(const fs::path& out, bool hashed) {
  std::error_code error;
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    if (process::is_stop_requested()) return fail("interrupted");
    std::error_code ignored;
    if (!it->is_directory(ignored) || it->is_symlink(ignored)) continue;
    if (hashed && it->path().filename().string().size() != 2) continue;
    if (auto tidied = hashed ? tidy_below(it->path(), false) : tidy(it->path()); !tidied)
      return tidied;
  }
  if (error) return fail("cannot read the output folder " + out.string() + ": " + error.message());
  return {};
}

/// Nothing half-done is left in a folder that somebody reads. Where a run was cut short, it may lie
/// in folders of campaigns that are not in the site any more.
Expected<void> tidy_all(const Night& night, const fs::path& out, bool resumed) {
  tidy_root(out);
  if (resumed) return tidy_below(out, storage::results_folder(out, "a") != out / "a");
  for (const CampaignState& c : night.campaigns) {
    if (process::is_stop_requested()) return fail("interrupted");
    if (c.action == Action::done && c.is_campaign)
      if (auto tidied = tidy(storage::results_folder(out, c.id)); !tidied) return tidied;
  }
  return {};
}

/// Campaigns that somebody has said to be gone are none that vanished.
void leave_out_forgotten(Night& night, const Expected<history::Told>& told) {
  if (!told) return;
  std::erase_if(night.vanished, [&](const Vanished& v) {
    return std::any_of(told->logs.forgotten.begin(), told->logs.forgotten.end(),
                       [&](const config::Forgotten& f) { return f.campaign == v.id; });
  });
}

/// An index that cannot be written is no reason to lose a night: it is made again from the results.
void write_history(Night& night, const HistoryUpdate& history, const NightState& state,
                   const Expected<history::Told>& told, const RunEvents& events) {
  std::vector<std::string> done;
  for (const CampaignState& c : night.campaigns)
    if (c.action == Action::done && c.is_campaign) done.push_back(c.id);
  const std::uint64_t known = state.reopened ? state.number
                              : state.last   ? state.last->night.number
                                             : 0;
  auto notes = history.end(known, state.number, done, told);
  if (!notes) {
    night.history_error = notes.error().message;
    notes = {"this night is not in the history: " + night.history_error +
             "; the results are all there, and the next night enters them"};
  } else if (!notes->empty()) {
    night.history_error = notes->front();
  }
  for (std::string& note : *notes) {
    events.note(note);
    night.notes.push_back(std::move(note));
  }
}

/// Pages that cannot be made are no reason to lose a night: they are made again from the results.
Morning morning_of(Night& night, const RunOptions& options, const RunEvents& events,
                   const reading::Context& context) {
  auto made = make_morning(options, context, tonight_of(night, options.out, context.templates));
  if (made) return std::move(*made);
  if (process::is_stop_requested()) return {};
  night.morning_error = "the pages of the morning were not made: " + made.error().message;
  night.notes.push_back(night.morning_error + "; the next night makes them");
  events.note(night.notes.back());
  return {};
}

/// A mail that cannot be sent is said in the summary, and loses nothing.
void write_mail(Night& night, const RunOptions& options, const RunEvents& events,
                const reading::Context& context, const Morning& morning) {
  if (morning.mail.empty() || process::is_stop_requested()) return;
  const config::TerminalWords words(context.templates, context.site.language);
  const std::string subject = words(
      "mail.subject", {{"number", std::to_string(night.night.number)}, {"date", night.night.date}});
  const auto sent = send_mail(*context.site.mail, options.site, {subject, morning.mail});
  if (sent) return;
  night.morning_error = "the mail of this night was not sent: " + sent.error().message;
  night.notes.push_back(night.morning_error);
  events.note(night.notes.back());
}

/// First what cannot be left lying; then what the register says; the summary last.
Expected<void> close_night(Night& night, const RunOptions& options, const RunEvents& events,
                           const reading::Context& context, NightState& state) {
  if (auto tidied = tidy_all(night, options.out, state.resumed); !tidied) return tidied;
  if (auto noted = note_certificates(night, options, context, state); !noted) return noted;
  const Morning morning = morning_of(night, options, events, context);
  if (!state.reopened) write_mail(night, options, events, context, morning);
  const config::TerminalWords words(context.templates, context.site.language);
  if (auto written = write_summary(night, options.out, options.version, words, morning); !written)
    return written;
  return end_night(options.out, state, {state.of(), night.campaigns.size(), night.failed()});
}

/// All of them stand in the summary; of very many the messages name the first.
void tell_vanished(const Night& night, const RunEvents& events) {
  constexpr std::size_t most = 100;
  for (std::size_t i = 0; i < std::min(most, night.vanished.size()); ++i)
    events.note("campaign " + night.vanished[i].id + " has vanished: " + night.vanished[i].why);
  if (night.vanished.size() > most)
    events.note("and " + std::to_string(night.vanished.size() - most) +
                " more campaigns have vanished: see the summary");
}

/// Of a night that is reopened: one campaign is to do, every other one stands as the night left it.
/// An error if no campaign has that folder or id.
Expected<void> leave_only(const RunOptions& options, const NightState& state, Night& night) {
  std::error_code error;
  std::string below = fs::path(options.only).lexically_normal().generic_string();
  while (below.ends_with('/')) below.pop_back();
  // As a person in another folder writes it.
  const std::string from_here = fs::weakly_canonical(options.only, error)
                                    .lexically_relative(fs::weakly_canonical(options.site, error))
                                    .generic_string();
  std::size_t found = 0;
  for (CampaignState& c : night.campaigns) {
    const std::string folder = fs::path(c.folder).generic_string();
    const bool is_one =
        c.is_campaign && (c.id == options.only || folder == below || folder == from_here);
    if (is_one) ++found;
    if (is_one && c.action != Action::todo) {
      c.action = Action::todo;
      c.status = evaluation::Status::none;
      c.errors.clear();
      c.reason = "--only";
    }
    if (is_one || c.action != Action::todo) continue;
    const auto record = evaluation::read_record(storage::results_folder(options.out, c.id));
    const bool tonight = record && record->night == state.number;
    c.action = tonight ? Action::done : Action::unchanged;
    c.status = record ? record->status : evaluation::Status::none;
    c.errors = record ? record->errors : std::vector<Error>{};
    c.reason = tonight ? record->reason : "nothing changed";
  }
  if (found == 1) return {};
  return fail("--only: there is " + std::string(found == 0 ? "no" : "more than one") +
              " campaign with the folder or id \"" + options.only + "\" in this site");
}

/// Those that came after the night are the next one's.
void leave_out_new(const NightState& state, std::vector<CampaignState>& campaigns) {
  if (!state.reopened) return;
  std::erase_if(campaigns, [](const CampaignState& c) {
    return c.action != Action::todo && c.status == evaluation::Status::none;
  });
}

/// The night itself, in an output folder that nobody else uses.
void do_night(const RunOptions& options, const RunEvents& events, const std::string& site_text,
              SetUp& place, const std::optional<Known>& known, Night& night) {
  const reading::Context& context = place.context;
  const auto refuse = [&](std::string why) {
    night.end = process::is_stop_requested() ? Night::End::interrupted : Night::End::refused;
    night.error = std::move(why);
  };
  if (const auto settled =
          settle_folders(options.out, context.site.hashed_folders, options.dry_run);
      !settled)
    return refuse(settled.error().message);
  auto state =
      !options.only.empty()
          ? reopen_night(options, site_text)
          : begin_night(options, site_text,
                        known ? std::optional(issued_so_far(known->numbers)) : std::nullopt);
  if (!state) return refuse(state.error().message);
  night.night = state->of();
  if (state->last) night.seen_before = state->last->seen;
  const std::size_t notes_so_far = night.notes.size();
  SurveyInput input{options.site,
                    options.out,
                    context,
                    state->number,
                    state->force,
                    std::nullopt,
                    {},
                    night.notes,
                    process::is_stop_requested,
                    options.verify_results};
  if (known) {
    input.numbers = known->numbers;
    for (const certificates::WaitingDraft& draft : known->drafts)
      input.drafts.insert(draft.campaign);
  }
  const auto stage = [&](const char* name) {
    if (events.stage) events.stage(name);
  };
  stage("survey");
  auto surveyed = survey(input);
  if (process::is_stop_requested()) {
    night.end = Night::End::interrupted;
    return;
  }
  if (!surveyed) return refuse(surveyed.error().message);
  night.campaigns = std::move(surveyed->campaigns);
  night.vanished = std::move(surveyed->vanished);
  if (state->reopened)
    if (const auto well = leave_only(options, *state, night); !well)
      return refuse(well.error().message);
  const auto told = read_told(options, context);
  leave_out_forgotten(night, told);
  night.may_vanish = context.site.limits.vanished;
  for (std::size_t i = notes_so_far; i < night.notes.size(); ++i) events.note(night.notes[i]);
  tell_vanished(night, events);
  const auto is_todo = [](const CampaignState& c) { return c.action == Action::todo; };
  events.planned(night.campaigns.size(),
                 static_cast<std::size_t>(
                     std::count_if(night.campaigns.begin(), night.campaigns.end(), is_todo)));
  if (options.dry_run) return;

  stage("campaigns");
  HistoryUpdate history(options, context);
  if (const auto begun = history.begin(); !begun) return refuse(begun.error().message);
  store_refused(options, context, *state, events, night.campaigns);
  ReleaseDesk desk;
  auto& signer = place.signer;
  desk.signer = signer ? &*signer : nullptr;
  desk.plugins = &*place.host;
  if (!known)
    desk.recheck = [&](const std::vector<certificates::RegisterEntry>& numbers) {
      if (!state->issued_before) state->issued_before = issued_so_far(numbers);
      return check_numbers(options.out, night.campaigns, numbers);
    };
  if (!do_campaigns(options, events, context, *state, desk, night.campaigns)) {
    night.end = Night::End::interrupted;
    if (state->reopened && std::any_of(night.campaigns.begin(), night.campaigns.end(), is_todo))
      history.nothing_done();
    tidy_root(options.out);
    return;
  }
  leave_out_new(*state, night.campaigns);
  stage("history");
  if (!process::is_stop_requested()) write_history(night, history, *state, told, events);
  stage("pages");
  // The campaigns are safe; if this fails the night stays open, and the next run ends it.
  const auto closed = close_night(night, options, events, context, *state);
  if (closed) return;
  tidy_root(options.out);
  if (process::is_stop_requested()) return refuse({});
  night.error = closed.error().message + "; the same command goes on where it stopped";
}

}  // namespace

Night run_site(const RunOptions& options, const RunEvents& events) {
  Night night;
  const auto refuse = [&](std::string why) {
    night.end = process::is_stop_requested() ? Night::End::interrupted : Night::End::refused;
    night.error = std::move(why);
    return std::move(night);
  };
  const auto site_text = look_at_site(options);
  if (!site_text) return refuse(site_text.error().message);
  const auto place = set_up(options);
  if (!place) return refuse(place.error().message);
  const reading::Context& context = (*place)->context;
  night.notes = (*place)->notes;

  std::optional<OutputLock> lock;
  if (!options.dry_run) {
    auto taken = OutputLock::take(options.out);
    if (!taken) return refuse(taken.error().message);
    lock.emplace(std::move(*taken));
  }
  const auto known = known_of(options, context);
  if (!known) return refuse(known.error().message);
  if (!*known)
    night.notes.push_back(
        "another process keeps the register of certificates locked: campaigns that need a number "
        "wait for it");
  for (const std::string& note : night.notes) events.note(note);
  if (!(*place)->unstamped.empty()) night.notes.push_back((*place)->unstamped);
  // What takes the memory goes first, then there is enough to tell of it.
  auto reserve = std::make_unique<std::array<char, 1 << 18>>();
  try {
    do_night(options, events, *site_text, **place, *known, night);
  } catch (const std::exception& e) {
    reserve.reset();
    night.error = dynamic_cast<const std::bad_alloc*>(&e) != nullptr
                      ? "out of memory; the same command goes on where it stopped"
                      : e.what();
    if (lock) [[maybe_unused]]
      const auto tidied = tidy_all(night, options.out, true);
  }
  return night;
}

}  // namespace nonio::host::batch
