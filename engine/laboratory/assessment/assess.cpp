// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/assess.h"

#include <sys/stat.h>

#include <algorithm>
#include <set>
#include <utility>

#include "laboratory/assessment/changes.h"
#include "laboratory/assessment/days.h"
#include "laboratory/assessment/describe.h"
#include "laboratory/assessment/kept_machines.h"
#include "laboratory/assessment/lines.h"
#include "laboratory/assessment/proposals.h"
#include "laboratory/assessment/series.h"
#include "laboratory/assessment/site_tables.h"
#include "laboratory/store/query.h"
#include "laboratory/store/reader.h"
#include "platform/storage/digest.h"
#include "platform/storage/serialise.h"

namespace nonio::assessment {
namespace fs = std::filesystem;

namespace {

struct Due {
  std::string day, why;  ///< `why` is the interval in months
};

std::optional<int> months_of_rule(const std::string& machine, const store::StoredLogs& logs) {
  auto rule = logs.due.find(machine);
  if (rule == logs.due.end()) rule = logs.due.find("");
  return rule == logs.due.end() ? std::nullopt : std::optional(rule->second);
}

Due due_of(const AssessedMachine& m, const store::StoredLogs& logs) {
  const auto months = months_of_rule(m.state.machine.name, logs);
  // A campaign without a machine has no due date.
  if (!months || m.stored.campaigns.empty() || m.state.machine.name.empty()) return {};
  return {months_later(m.stored.campaigns.back().day, *months), std::to_string(*months)};
}

std::string page_of(const fs::path& out, const reports::MachineHistory& machine) {
  return (out / reports::machines_folder / machine.file).string();
}

}  // namespace

class Assessment::State {
 public:
  State(const fs::path& out, const LastRun& last_run, const std::function<void()>& alive,
        store::StoreReader store, Kept use_kept, const config::SiteLogs* entered)
      : out_(out),
        last_run_(last_run),
        alive_(alive),
        store_(std::move(store)),
        entered_(entered),
        kept_(out) {
    if (use_kept == Kept::ignored) return;
    before_ = kept_.machines();
    runs_ = kept_.runs();
  }

  Expected<void> make() {
    NONIO_TRY(auto logs, store_.logs());
    logs_ = std::move(logs);
    if (entered_ != nullptr) take_entered(*entered_);
    if (auto well = list_machines(); !well) return well;
    if (auto well = learn_all(); !well) return well;
    if (auto well = fit_all(); !well) return well;
    if (auto well = judge_all(); !well) return well;
    return put_together();
  }

  Expected<const reports::MachineHistory*> whole(std::size_t i) {
    Assessed& m = machines_[i];
    if (!m.described)
      if (auto well = finish(m); !well) return fail(well.error());
    m.read.reset();
    m.described->proposal = site.machines[i].proposal;
    return &*m.described;
  }

  std::string page_key(std::size_t i, const std::string& templates) const {
    const Assessed& m = machines_[i];
    const auto lines = lines_.find(m.state.machine.name);
    storage::ValueWriter w;
    // A page must be written again after the date of a forecast.
    w(m.kept.digest, m.kept.standing.until, templates,
      lines == lines_.end() ? std::string() : bytes_of(lines->second),
      bytes_of(site.machines[i].proposal));
    return storage::sha256(w.take());
  }

  bool has_page(std::size_t i, const std::string& templates) const {
    const KeptMachine::Page& page = machines_[i].kept.page;
    struct stat info {};
    return !page.made_from.empty() && page.made_from == page_key(i, templates) &&
           ::stat(page_of(out_, site.machines[i]).c_str(), &info) == 0 &&
           static_cast<std::uint64_t>(info.st_size) == page.size && changed(info) == page.changed;
  }

  void note_page(std::size_t i, const std::string& templates) {
    struct stat info {};
    KeptMachine::Page& page = machines_[i].kept.page;
    page = {};
    machines_[i].is_new = true;
    if (::stat(page_of(out_, site.machines[i]).c_str(), &info) == 0)
      page = {page_key(i, templates), static_cast<std::uint64_t>(info.st_size), changed(info)};
    machines_[i].described.reset();
  }

  void keep(Keep what) {
    KeptMachines::Changes changes;
    const bool all = what == Keep::all;
    for (const auto& [name, kept] : before_) changes.gone.insert(name);
    for (Assessed& m : machines_) {
      const std::string name = m.key();
      changes.gone.erase(name);
      const bool trends = m.fits && m.fits->is_new();
      if (!trends && !(all && m.is_new)) continue;
      changes.machines.push_back({name, all && m.is_new ? &m.kept : nullptr,
                                  trends ? std::optional(m.fits->kept()) : std::nullopt});
    }
    if (all && runs_are_new_) changes.runs = runs_;
    kept_.keep(changes);
  }

  std::size_t count() const { return machines_with_name_; }

  reports::SiteHistory site;

 private:
  void take_entered(const config::SiteLogs& now) {
    logs_.acknowledged = now.acknowledged;
    // An acknowledgement entered after the run applies at once, even if its date is later.
    for (config::Acknowledgement& a : logs_.acknowledged) a.date = std::min(a.date, last_run_.date);
    for (const config::Event& e : now.events)
      if (std::none_of(logs_.events.begin(), logs_.events.end(), [&](const config::Event& known) {
            return known.date == e.date && known.machine == e.machine && known.axis == e.axis &&
                   known.kind == e.kind && known.text == e.text;
          }))
        logs_.events.push_back(e);
  }

  struct Assessed {
    store::MachineState state;
    std::string alone{};
    /// A line feed, which is not valid in the name of a machine, marks a campaign.
    std::string key() const { return alone.empty() ? state.machine.name : '\n' + alone; }
    std::vector<config::Event> events;
    std::vector<std::string> campaigns;
    KeptMachine kept;
    bool is_new = false;
    std::optional<Fits> fits{};
    std::optional<AssessedMachine> read{};  ///< data of the store, unless `kept` is sufficient
    bool fitted = false;
    std::vector<std::vector<Adjusted>> adjusted{};
    std::optional<reports::MachineHistory> described{};
  };

  static std::int64_t changed(const struct stat& info) {
    return std::int64_t{info.st_mtim.tv_sec} * 1'000'000'000 + info.st_mtim.tv_nsec;
  }

  /// Results of the previous run are used for machines with unchanged data.
  Expected<void> list_machines() {
    NONIO_TRY(auto states, store_.machines());
    NONIO_TRY(auto evaluations, store_.evaluations());
    NONIO_TRY(auto numbers, store_.certificates());
    if (auto well = count_tests(evaluations); !well) return well;
    learned_from_ = learned_from(evaluations.size());
    std::map<std::string, std::vector<const store::StoredEvaluation*>> of_machine;
    for (const auto& e : evaluations) of_machine[e.machine].push_back(&e);
    std::set<std::string> forgotten;
    for (const config::Forgotten& f : logs_.forgotten) forgotten.insert(f.campaign);
    const MachineNames names(states, logs_);
    for (config::Acknowledgement& a : logs_.acknowledged)
      if (const std::string* name = names.of(a.machine)) a.machine = *name;
    const MachineEvents events(states, logs_);
    note_unknown(states, events);
    const auto add = [&](Assessed m, const std::vector<const store::StoredEvaluation*>& all) {
      alive_();
      storage::ValueWriter rows;
      rows(learned_from_);
      put_identity(rows, m);
      for (const store::StoredEvaluation* e : all) {
        rows(e->campaign, e->sha256, e->run, e->counts, e->day > until_);
        if (!e->counts) continue;
        m.campaigns.push_back(e->campaign);
        if (const auto n = numbers.find(e->campaign); n != numbers.end()) rows(n->second);
      }
      if (std::all_of(m.campaigns.begin(), m.campaigns.end(),
                      [&](const std::string& id) { return forgotten.contains(id); }))
        return;
      const std::string rows_key = storage::sha256(rows.take());
      if (const auto kept = before_.find(m.key());
          kept != before_.end() && kept->second.rows == rows_key)
        m.kept = std::move(kept->second);
      m.is_new = m.kept.rows != rows_key;
      m.kept.rows = rows_key;
      machines_.push_back(std::move(m));
    };
    for (const store::MachineState& state : states)
      add({.state = state, .events = events.of(state.machine.name), .campaigns = {}, .kept = {}},
          of_machine[state.machine.name]);
    machines_with_name_ = machines_.size();
    std::map<std::string, std::vector<const store::StoredEvaluation*>> of_campaign;
    for (const store::StoredEvaluation* e : of_machine[""]) of_campaign[e->campaign].push_back(e);
    for (const auto& [id, all] : of_campaign) {
      if (std::none_of(all.begin(), all.end(), [](const auto* e) { return e->counts; })) continue;
      store::MachineState none{};
      for (const store::StoredEvaluation* e : all) none.run = std::max(none.run, e->run);
      add({.state = none, .alone = id, .events = {}, .campaigns = {}, .kept = {}}, all);
    }
    return {};
  }

  /// Collects machines that no campaign names, from events, valid acknowledgements and calibration
  /// intervals. Machines with events in their records are excluded, because records may precede
  /// campaigns.
  void note_unknown(const std::vector<store::MachineState>& states, const MachineEvents& events) {
    std::set<std::string> names;
    for (const store::MachineState& state : states) names.insert(state.machine.name);
    for (const config::Event& e : events.of_none())
      if (!logs_.recorded.contains(e.machine)) put_unknown(e.machine, config::events_name, e.line);
    for (const config::Acknowledgement& a : logs_.acknowledged) {
      const auto alias = logs_.aliases.find(a.machine);
      const std::string& name = alias == logs_.aliases.end() ? a.machine : alias->second;
      if (!name.empty() && !names.contains(name) && a.until >= last_run_.date)
        put_unknown(a.machine, config::acknowledged_name, a.line);
    }
    for (const auto& [machine, months] : logs_.due)
      if (!machine.empty() && !names.contains(machine))
        unknown_.push_back(machine + " (site.toml)");
  }

  void put_unknown(const std::string& machine, const char* file, std::uint64_t line) {
    unknown_.push_back(machine + " (" + file + ":" + std::to_string(line) + ")");
  }

  static void put_identity(storage::ValueWriter& rows, const Assessed& m) {
    const store::NamedMachine& named = m.state.machine;
    rows(named.name, named.stated.asset, named.stated.maker, named.stated.model,
         named.stated.serial);
    for (const config::Event& e : m.events) rows(e.date, e.axis, e.kind, e.text);
    rows(std::uint64_t{m.events.size()});
  }

  Expected<void> count_tests(const std::vector<store::StoredEvaluation>& evaluations) {
    std::map<std::uint64_t, storage::ValueWriter> of_run;
    for (const store::StoredEvaluation& e : evaluations)
      of_run[e.run](e.machine, e.campaign, e.sha256);
    std::map<std::uint64_t, KeptMachines::RunResult> runs;
    std::optional<std::uint64_t> first;
    for (auto& [run, bytes] : of_run) {
      const std::string key = storage::sha256(bytes.take());
      const auto kept = runs_.find(run);
      const bool same = kept != runs_.end() && kept->second.made_from == key;
      runs[run] = {key, same ? kept->second.asked : 0};
      if (!same && !first) first = run;
    }
    if (first) {
      NONIO_TRY(const auto counted, store_.followed_since(*first));
      for (auto at = runs.lower_bound(*first); at != runs.end(); ++at) {
        const auto found = counted.find(at->first);
        at->second.asked = found == counted.end() ? 0 : found->second;
      }
    }
    runs_are_new_ = first || runs.size() != runs_.size();
    runs_ = std::move(runs);
    return {};
  }

  Expected<void> read(Assessed& m) {
    NONIO_TRY(auto stored, m.alone.empty() ? store_.machine(m.state.machine.name, until_)
                                           : store_.campaign(m.alone, until_));
    AssessedMachine read{m.state, std::move(stored), m.events, {}, {}};
    if (m.alone.empty()) read.followed = followed_series(read.stored, read.events);
    read.shown = shown_series(read.stored, read.events);
    m.kept.series.resize(read.followed.size());
    if (!m.fits) m.fits = Fits::of(kept_.trends_of(m.key()));
    for (std::size_t k = 0; k < read.followed.size(); ++k)
      m.kept.series[k].lesson = lesson_of(read.followed[k], *m.fits, learned_from_);
    m.read = std::move(read);
    m.fitted = false;
    return {};
  }

  Expected<void> learn_all() {
    std::vector<const Lesson*> lessons;
    for (Assessed& m : machines_) {
      alive_();
      if (m.kept.digest.empty())
        if (auto well = read(m); !well) return well;
      for (const KeptMachine::Series& s : m.kept.series) lessons.push_back(&s.lesson);
    }
    learned_ = learn(lessons);
    return {};
  }

  void fit_series(Assessed& m) {
    for (std::size_t k = 0; k < m.read->followed.size(); ++k) {
      KeptMachine::Series& kept = m.kept.series[k];
      kept.manner = manner_of(kept.lesson.quantity, learned_);
      fit(m.read->followed[k], kept.manner, *m.fits);
      kept.tests = tests_of(m.read->followed[k]);
    }
    m.fitted = true;
  }

  Expected<void> fit_all() {
    for (Assessed& m : machines_) {
      alive_();
      const bool as_before =
          !m.read && std::all_of(m.kept.series.begin(), m.kept.series.end(),
                                 [&](const KeptMachine::Series& s) {
                                   return s.manner == manner_of(s.lesson.quantity, learned_);
                                 });
      if (as_before) continue;
      if (!m.read)
        if (auto well = read(m); !well) return well;
      fit_series(m);
      m.is_new = true;
    }
    return {};
  }

  Expected<void> judge_all() {
    std::vector<const SeriesTests*> tests;
    for (const Assessed& m : machines_)
      for (const KeptMachine::Series& s : m.kept.series) tests.push_back(&s.tests);
    std::map<std::uint64_t, std::uint64_t> asked;
    for (const auto& [run, of] : runs_) asked[run] = of.asked;
    auto p = adjusted_by_run(tests, asked);
    std::size_t next = 0;
    for (Assessed& m : machines_) {
      alive_();
      for (std::size_t k = 0; k < m.kept.series.size(); ++k)
        m.adjusted.push_back(std::move(p[next++]));
      const std::string key = standing_key(m);
      if (key == m.kept.digest && m.kept.date <= last_run_.date &&
          last_run_.date <= m.kept.standing.until) {
        m.read.reset();
        continue;
      }
      if (auto well = finish(m); !well) return well;
      m.kept.standing = standing_of(*m.read, *m.described, logs_, last_run_, out_);
      m.kept.standing.interval =
          interval_facts(*m.read, months_of_rule(m.state.machine.name, logs_));
      m.kept.digest = key;
      m.kept.date = last_run_.date;
      m.is_new = true;
      m.read.reset();
    }
    return {};
  }

  std::string standing_key(const Assessed& m) const {
    storage::ValueWriter w;
    w(m.kept.rows);
    for (std::size_t k = 0; k < m.kept.series.size(); ++k) {
      const KeptMachine::Series& s = m.kept.series[k];
      w(s.manner.excess, s.manner.spread, s.manner.drift_below);
      for (std::size_t i = 0; i < s.tests.changes.size(); ++i) {
        const Verdict v = verdict_of(s.tests.changes[i], m.adjusted[k][i]);
        w(v.significant, v.surely, v.mailed, v.significant ? m.adjusted[k][i].news : 1.0);
      }
    }
    w(std::int64_t{months_of_rule(m.state.machine.name, logs_).value_or(0)});
    for (const config::Acknowledgement* a : acknowledgements_of(m.state.machine.name, logs_))
      w(a->date, a->finding, a->machine, a->axis, a->quantity, a->until, a->value, a->U, a->by,
        a->why);
    for (const std::string& campaign : m.campaigns) w(links_.of(campaign));
    // Results of the present run are reported as new, so its number is part of the key.
    if (m.state.run >= last_run_.run) w(last_run_.run);
    return storage::sha256(w.take());
  }

  Expected<void> finish(Assessed& m) {
    if (!m.read)
      if (auto well = read(m); !well) return well;
    if (!m.fitted) fit_series(m);
    for (std::size_t k = 0; k < m.read->followed.size(); ++k) {
      tell(m.read->followed[k], m.adjusted[k]);
      drop_unstated(m.read->followed[k], *m.fits);
    }
    ask_others(*m.read, *m.fits);
    const Due due = due_of(*m.read, logs_);
    m.described = describe(*m.read, out_, due.day, due.why, last_run_.date);
    if (!m.alone.empty()) m.described->file.clear();
    m.fitted = false;
    return {};
  }

  Expected<void> put_together() {
    Expected<std::map<std::string, std::string>> machine_of_campaign;
    if (!last_run_.vanished.empty() || !last_run_.failed.empty())
      machine_of_campaign = store_.machine_of_campaigns();
    if (!machine_of_campaign) return fail(machine_of_campaign.error());
    NONIO_TRY(const auto spellings, store::spellings_in(out_));
    site.run = last_run_.run, site.date = last_run_.date;
    site.campaigns = last_run_.campaigns, site.done = last_run_.done;
    site.unchanged = last_run_.unchanged;
    site.certificates = last_run_.issued.size(), site.waiting = last_run_.waiting.size();
    std::vector<const Standing*> standings;
    std::vector<const std::vector<reports::InstrumentUse>*> instruments;
    std::vector<const IntervalFacts*> intervals;
    for (const Assessed& m : machines_) {
      const Standing& s = m.kept.standing;
      standings.push_back(&s);
      instruments.push_back(&s.instruments);
      intervals.push_back(&s.interval);
      if (s.alone) continue;
      site.machines.push_back(s.shown);
      site.months.insert(site.months.end(), s.months.begin(), s.months.end());
    }
    // Campaigns without a machine are last and get no proposal.
    intervals.resize(site.machines.size());
    auto proposals = proposals_of(intervals);
    for (std::size_t i = 0; i < proposals.size(); ++i)
      site.machines[i].proposal = std::move(proposals[i]);
    site.judged = std::any_of(standings.begin(), standings.end(),
                              [](const Standing* s) { return s->judged; });
    site.lines =
        lines_of({last_run_, standings, *machine_of_campaign, spellings, learned_.of, unknown_});
    for (const reports::WorkItem& l : site.lines) lines_[l.machine].push_back(l);
    site.instruments = joined(instruments);
    site.out_of_force = last_run_.out_of_force;
    std::vector<ComparedMachine> compared;
    for (const Standing* s : standings)
      if (!s->alone) compared.push_back({&s->shown, &s->compared});
    site.comparisons = comparisons_of(compared);
    return add_sparks();
  }

  Expected<void> add_sparks() {
    for (const std::string& name : reports::drawn_first(site)) {
      const auto at = std::lower_bound(
          site.machines.begin(), site.machines.end(), name,
          [](const reports::MachineHistory& m, const std::string& x) { return m.id < x; });
      if (at == site.machines.end() || at->id != name) continue;
      NONIO_TRY(const auto whole_one, whole(static_cast<std::size_t>(at - site.machines.begin())));
      *at = *whole_one;
    }
    return {};
  }

  fs::path out_;
  LastRun last_run_;
  std::function<void()> alive_;
  store::StoreReader store_;
  const config::SiteLogs* entered_;
  store::StoredLogs logs_{};
  KeptMachines kept_;
  std::map<std::string, KeptMachine> before_{};
  std::map<std::uint64_t, KeptMachines::RunResult> runs_{};
  bool runs_are_new_ = false;
  Learned learned_{};
  std::uint64_t learned_from_ = 0;
  std::vector<Assessed> machines_{};
  std::size_t machines_with_name_ = 0;
  std::vector<std::string> unknown_{};
  const Links links_{out_};
  const std::string until_ = last_run_.date.empty() ? "9999-12-31" : last_run_.date;
  std::map<std::string, std::vector<reports::WorkItem>> lines_{};
};

Assessment::Assessment(std::unique_ptr<State> state) : state_(std::move(state)) {}
Assessment::Assessment(Assessment&&) noexcept = default;
Assessment::~Assessment() = default;

Expected<Assessment> Assessment::of(const fs::path& out, const LastRun& last_run,
                                    const std::function<void()>& alive, Kept kept,
                                    const config::SiteLogs* entered) {
  NONIO_TRY(auto store, store::StoreReader::open(out));
  auto state = std::make_unique<State>(out, last_run, alive, std::move(store), kept, entered);
  if (auto made = state->make(); !made) return fail(made.error());
  return Assessment(std::move(state));
}

const reports::SiteHistory& Assessment::site() const { return state_->site; }
Expected<reports::MachineHistory> Assessment::whole(std::size_t machine) {
  NONIO_TRY(const auto found, state_->whole(machine));
  return *found;
}
bool Assessment::has_page(std::size_t machine, const std::string& templates) const {
  return state_->has_page(machine, templates);
}
void Assessment::note_page(std::size_t machine, const std::string& templates) {
  state_->note_page(machine, templates);
}
void Assessment::keep() { state_->keep(Keep::all); }

Expected<reports::SiteHistory> assess(const fs::path& out, const LastRun& last_run,
                                      const std::function<void()>& alive, Keep keep) {
  NONIO_TRY(auto made, Assessment::of(out, last_run, alive, Assessment::Kept::ignored));
  return std::move(made).take_whole(keep);
}

reports::SiteHistory Assessment::take_site() && { return std::move(state_->site); }

Expected<reports::SiteHistory> Assessment::take_whole(Keep keep) && {
  for (std::size_t i = 0; i < state_->count(); ++i) {
    NONIO_TRY(auto machine, whole(i));
    state_->site.machines[i] = std::move(machine);
  }
  if (keep != Keep::nothing) state_->keep(keep);
  return std::move(state_->site);
}

}  // namespace nonio::assessment
