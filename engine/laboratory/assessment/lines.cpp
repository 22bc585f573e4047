// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/lines.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "campaign/config/manifest.h"
#include "laboratory/assessment/lines_of_machine.h"
#include "nonio/reports/quantity_words.h"

namespace nonio::assessment {

using reports::WorkItem;
using Kind = WorkItem::Kind;

namespace {

constexpr std::size_t most_alike = 3;
constexpr std::size_t most_machines = 5;

void put_count(WorkItem& line, const char* name, std::size_t n) {
  line.finding.evidence.push_back({name, static_cast<double>(n), Quantity::count});
}

/// Makes one line per machine with missing campaigns, or one per top folder if there are more than
/// `most_machines` machines. Campaigns without a machine and other parts of the site have separate
/// lines.
std::vector<WorkItem> lost(const Known& known) {
  std::map<std::string, std::vector<const LastRun::Vanished*>> by_machine, by_folder;
  std::vector<WorkItem> out;
  for (const LastRun::Vanished& v : known.last_run.vanished) {
    if (!config::is_campaign_id(v.campaign)) {
      out.push_back(line_of(Kind::lost, "worklist.lost-part", v.campaign));
      put_text(out.back(), "part", v.campaign);
      put_text(out.back(), "why", v.why);
      continue;
    }
    const auto machine = known.machine_of_campaign.find(v.campaign);
    by_machine[machine == known.machine_of_campaign.end() ? "" : machine->second].push_back(&v);
    by_folder[v.folder.substr(0, v.folder.find('/'))].push_back(&v);
  }
  const bool many = by_machine.size() > most_machines;
  for (const auto& [name, gone] : many ? by_folder : by_machine) {
    if (gone.size() == 1 || (!many && name.empty())) {
      for (const LastRun::Vanished* v : gone) {
        WorkItem line = line_of(Kind::lost, "worklist.lost", v->campaign);
        line.machine = many ? "" : name;
        line.campaign = v->campaign;
        put_count(line, "night", v->last_seen_run);
        put_text(line, "folder", v->folder);
        put_text(line, "why", v->why);
        out.push_back(std::move(line));
      }
      continue;
    }
    WorkItem line = line_of(Kind::lost, "worklist.lost-several", name);
    line.machine = many ? "" : name;
    line.campaign = gone.front()->campaign;
    std::uint64_t run = 0;
    for (const LastRun::Vanished* v : gone) run = std::max(run, v->last_seen_run);
    put_count(line, "night", run);
    put_count(line, "count", gone.size());
    put_text(line, "of", name);
    for (const LastRun::Vanished* v : gone) line.campaigns.push_back(v->campaign);
    out.push_back(std::move(line));
  }
  return out;
}

/// More than `most_alike` failures with the same message, such as a mistake in site.toml, are one
/// line. An error of the history is a separate line.
std::vector<WorkItem> failed(const Known& known) {
  std::map<std::string, std::vector<const LastRun::Failed*>> by_message;
  for (const LastRun::Failed& f : known.last_run.failed) by_message[f.message].push_back(&f);
  std::vector<WorkItem> out;
  if (!known.last_run.history_error.empty()) {
    out.push_back(line_of(Kind::failed, "worklist.history", "history"));
    put_text(out.back(), "message", known.last_run.history_error);
  }
  for (const auto& [message, alike] : by_message) {
    if (alike.size() > most_alike) {
      WorkItem line = line_of(Kind::failed, "worklist.failed-several", alike.front()->campaign);
      line.campaign = alike.front()->campaign;
      line.since = alike.front()->since;
      put_count(line, "count", alike.size());
      put_text(line, "message", message);
      for (const LastRun::Failed* f : alike) line.campaigns.push_back(f->campaign);
      out.push_back(std::move(line));
      continue;
    }
    std::set<std::string> named;  // several folders can state one id
    for (const LastRun::Failed* f : alike) {
      if (!named.insert(f->campaign).second) continue;
      WorkItem line = line_of(Kind::failed, "worklist.failed", f->campaign);
      const auto machine = known.machine_of_campaign.find(f->campaign);
      if (machine != known.machine_of_campaign.end()) line.machine = machine->second;
      line.campaign = f->campaign;
      line.since = f->since;
      put_text(line, "message", message);
      out.push_back(std::move(line));
    }
  }
  return out;
}

void not_judged(const Known& known, std::vector<WorkItem>& out) {
  std::string names;
  std::size_t count = 0;
  for (const Standing* m : known.machines) {
    if (m->judged || !m->has_campaigns) continue;
    if (++count <= most_machines) names += (names.empty() ? "" : ", ") + m->name;
  }
  if (count == 0) return;
  out.push_back(line_of(Kind::information, "worklist.not-judged", "site"));
  put_count(out.back(), "count", count);
  put_text(out.back(), "machines", names + (count > most_machines ? ", ..." : ""));
}

void without_machine(const Known& known, std::vector<WorkItem>& out) {
  WorkItem line = line_of(Kind::information, "worklist.no-machine", "site");
  for (const Standing* m : known.machines)
    if (m->alone && !m->name.empty()) line.campaigns.push_back(m->name);
  if (line.campaigns.empty()) return;
  put_count(line, "count", line.campaigns.size());
  line.campaign = line.campaigns.front();
  out.push_back(std::move(line));
}

void drafts(const Known& known, std::vector<WorkItem>& out) {
  if (known.last_run.waiting.empty()) return;
  out.push_back(line_of(Kind::information, "worklist.draft", "site"));
  out.back().campaigns = known.last_run.waiting;
  out.back().campaign = known.last_run.waiting.front();
  put_count(out.back(), "count", known.last_run.waiting.size());
}

void misread(const Known& known, std::vector<WorkItem>& out) {
  WorkItem line = line_of(Kind::information, "worklist.misreading", "site");
  for (const Standing* m : known.machines)
    if (!m->misread.empty()) line.campaigns.push_back(m->misread);
  if (line.campaigns.empty()) return;
  put_count(line, "count", line.campaigns.size());
  line.campaign = line.campaigns.front();
  out.push_back(std::move(line));
}

void conforming(const Known& known, std::vector<WorkItem>& out) {
  std::size_t machines = 0, lost_motion = 0;
  for (const Standing* m : known.machines) {
    if (!m->judged || !m->conforms) continue;
    machines += m->attention;
    lost_motion += m->reversal;
  }
  if (machines == 0) return;
  out.push_back(line_of(Kind::information, "worklist.conforms", "site"));
  put_count(out.back(), "count", machines);
  put_count(out.back(), "reversal", lost_motion);
}

void unknown(const Known& known, std::vector<WorkItem>& out) {
  const std::size_t count = known.unknown.size();
  if (count == 0) return;
  std::string names;
  for (std::size_t i = 0; i < std::min(count, most_machines); ++i)
    names += (names.empty() ? "" : ", ") + known.unknown[i];
  out.push_back(line_of(Kind::information, "worklist.unknown-machine", "site"));
  put_count(out.back(), "count", count);
  put_text(out.back(), "where", names + (count > most_machines ? ", ..." : ""));
}

std::vector<WorkItem> of_site(const Known& known) {
  std::vector<WorkItem> out;
  without_machine(known, out);
  drafts(known, out);
  not_judged(known, out);
  misread(known, out);
  conforming(known, out);
  unknown(known, out);
  for (const store::Spelling& s : known.spellings) {
    out.push_back(line_of(Kind::information, "worklist.spelling", s.one + "|" + s.other));
    out.back().machine = s.one;
    put_text(out.back(), "one", s.one);
    put_text(out.back(), "other", s.other);
    put_text(out.back(), "alike", s.key());
  }
  std::string scatter;
  double most = 1.0;
  const double below =
      declared_below / static_cast<double>(std::max<std::size_t>(1, known.learned.size()));
  for (const auto& [quantity, of] : known.learned)
    if (of.excess > 1.2 && of.p < below) {
      const std::string name = quantity.substr(0, quantity.find(' '));
      scatter += (scatter.empty() ? "" : ", ") + name;
      most = std::max(most, of.excess);
    }
  if (!scatter.empty()) {
    out.push_back(line_of(Kind::information, "worklist.scatter", "site"));
    out.back().finding.evidence.push_back({"factor", most, Quantity::ratio});
    put_text(out.back(), "quantities", scatter);
  }
  return out;
}

/// Replaces more than `most_alike` new lines with this finding by one line. If many campaigns are
/// dated after the run, for example, the date of the run is probably wrong.
void fold(std::vector<WorkItem>& lines, const char* finding, const char* several) {
  const auto is_one = [&](const WorkItem& l) {
    return l.finding.id == finding && l.state == WorkItem::State::fresh;
  };
  const auto count = static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), is_one));
  if (count <= most_alike) return;
  WorkItem all = line_of(Kind::undecided, several, "site");
  std::string names;
  std::size_t named = 0;
  for (const WorkItem& l : lines)
    if (is_one(l)) all.campaigns.push_back(l.campaign);
  for (const WorkItem& l : lines)
    if (is_one(l) && named++ < most_machines)
      names +=
          (names.empty() ? "" : ", ") + l.machine + " " + (l.axis.empty() ? l.campaign : l.axis);
  put_count(all, "count", count);
  put_text(all, "where", names + (count > most_machines ? ", ..." : ""));
  std::erase_if(lines, is_one);
  lines.push_back(std::move(all));
}

/// Returns |value| / limit, or |value| / u without a limit, otherwise 0. Lines of one kind are
/// sorted by this number, largest first.
double size_of(const WorkItem& l) {
  if (l.value && l.limit && *l.limit > 0.0) return std::fabs(*l.value) / *l.limit;
  if (l.value && l.u && *l.u > 0.0) return std::fabs(*l.value) / *l.u;
  return 0.0;
}

bool wears(const WorkItem& l) {
  return l.kind == Kind::out && !l.finding.id.starts_with("worklist.out-changed");
}

/// Notes come last, acknowledged lines before them.
int rank_of(const WorkItem& l) {
  if (l.kind == Kind::information) return 2;
  return l.state == WorkItem::State::known ? 1 : 0;
}

bool comes_before(const WorkItem& a, const WorkItem& b) {
  const auto key = [](const WorkItem& l) {
    return std::tuple(rank_of(l), l.kind, l.state, wears(l), -size_of(l),
                      std::tie(l.machine, l.axis, l.id));
  };
  return key(a) < key(b);
}

}  // namespace

std::string kind_of(const std::string& quantity) {
  const auto is = [&](const char* begin) { return quantity.starts_with(begin); };
  if (reports::is_log_of_scatter(quantity)) return "scatter";
  if (is("B_mean") || is("backlash")) return "reversal";
  for (const char* of_circle :
       {"B_circle", "bow:", "lateral", "radius:", "scale_mismatch", "servo_mismatch"})
    if (is(of_circle)) return "circular";
  if (is("scale")) return "scale";
  if (quantity.substr(0, quantity.find(':')).find("curve") != std::string::npos) return "curve";
  if (is("turn")) return "turn";
  if (is("cyclic")) return "cyclic";
  if (is("squareness")) return "squareness";
  if (is("straightness")) return "straightness";
  if (is("centre") || is("direction") || is("chain_")) return "centre";
  return "parameter";
}

std::string axis_of(const std::string& axis, const std::string& quantity) {
  const auto colon = quantity.find(':');
  if (!axis.empty() || colon == std::string::npos) return axis;
  return quantity.substr(colon + 1, quantity.find('.', colon) - colon - 1);
}

std::vector<WorkItem> lines_of(const Known& known) {
  std::vector<WorkItem> out;
  const auto add = [&](std::vector<WorkItem> lines) {
    for (WorkItem& l : lines) out.push_back(std::move(l));
  };
  add(lost(known));
  add(failed(known));
  for (const Standing* m : known.machines) add(m->lines);
  fold(out, "worklist.later", "worklist.later-several");
  add(of_site(known));
  std::stable_sort(out.begin(), out.end(), comes_before);
  return out;
}

}  // namespace nonio::assessment
