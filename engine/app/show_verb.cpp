// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "campaign/config/terminal_words.h"
#include "campaign/evaluation/record.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/withheld.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "platform/storage/packed_results.h"
#include "shown_results.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct ShowWish {
  std::string folder, out = "out";
  bool all = false, opens = false, only_findings = false;
};

std::string joined_text(const std::vector<std::string>& parts, const char* between) {
  std::string text;
  for (const std::string& part : parts)
    if (!part.empty()) text += (text.empty() ? "" : between) + part;
  return text;
}

struct Grouped {
  std::string severity, title;
  std::vector<std::string> measurements{}, says{}, advice{};
};

void add_once(std::vector<std::string>& texts, const std::string& text) {
  if (!text.empty() && std::find(texts.begin(), texts.end(), text) == texts.end())
    texts.push_back(text);
}

/// Returns 0 if the result does not conform, 1 if indeterminate, 2 if it conforms, 3 without
/// tolerance.
int rank_of(const Json& value) {
  const std::string decision = value.value("decision", "");
  if (decision.empty()) return 3;
  if (decision == "does not conform" || decision == "fail") return 0;
  return decision == "cannot be decided" ? 1 : 2;
}

class Page {
 public:
  Page(const Shown& shown, bool all, std::string folder, std::ostream& out)
      : say_(shown.templates, shown.language),
        all_(all),
        folder_(std::move(folder)),
        out_(out),
        width_(line_width(STDOUT_FILENO)) {}

  void print(const Json& results) {
    head(results);
    for (const Json& e : results.at("errors")) error(e);
    std::string measurement;
    for (const Json& a : results.at("analyses")) analysis(a, measurement);
    if (results.contains("conformity")) undecided(results.at("conformity"));
    const Json tables = results.value("tables", Json::array());
    for (const Json& t : tables) collect(t, "");
    sort_findings();
    findings();
    compensation(tables, results.at("outputs"));
    if (results.contains("notes")) {
      heading(say_("notes"));
      notes(results);
    }
    outputs(results);
    if (results.at("status") == "failed")
      out_ << wrapped(say_("show.failed"), 0, width_);
    else if (!all_)
      out_ << wrapped(say_("show.all"), 0, width_);
  }

  Json findings_json(const Json& results) {
    for (const Json& a : results.at("analyses")) collect(a, a.value("measurement", ""));
    for (const Json& t : results.value("tables", Json::array())) collect(t, "");
    sort_findings();
    Json all = Json::array();
    for (Grouped& g : findings_) {
      if (is_of_one(g)) g.says.front() = without_measurement(g);
      all.push_back({{"severity", g.severity},
                     {"title", g.title},
                     {"measurements", g.measurements},
                     {"says", g.says},
                     {"advice", g.advice}});
    }
    return {{"schema", "nonio-findings/1"}, {"language", say_.language()}, {"findings", all}};
  }

 private:
  static std::string paint(const std::string& text, Colour colour) {
    return coloured(text, colour, STDOUT_FILENO);
  }
  void heading(const std::string& text) { out_ << "\n" << paint(text, Colour::bold) << "\n"; }
  std::string local(const std::string& number) const { return localised(number, say_.language()); }

  static std::string name_of(const Json& thing) {
    return joined_text(
        {thing.value("maker", ""), thing.value("model", ""), thing.value("serial", "")}, " ");
  }

  static bool requires_action(const Json& results) {
    for (const Json& value : results.value("conformity", Json::array()))
      if (rank_of(value) < 2) return true;
    for (const char* made : {"analyses", "tables", "outputs"})
      for (const Json& source : results.value(made, Json::array()))
        for (const Json& finding : source.value("findings", Json::array()))
          if (finding.value("severity", "") == "attention" &&
              is_withholding(finding.value("id", "")))
            return true;
    return false;
  }

  void head(const Json& results) {
    const Json& c = results.at("campaign");
    const std::string status = results.at("status");
    const Json nothing = Json::object();
    const std::string id = c.at("id"),
                      verdict = say_.of("status", status != "attention" || requires_action(results)
                                                      ? status
                                                      : "warnings");
    out_ << paint(id, Colour::bold) << "  " << paint(verdict, status_colour(status)) << "\n"
         << wrapped(joined_text({name_of(c.value("machine", nothing)), c.value("customer", ""),
                                 c.value("site", ""), c.value("date", "")},
                                " · "),
                    2, width_);
    if (all_)
      for (const auto& [name, text] : {std::pair{"operator", c.value("operator", "")},
                                       {"instrument", name_of(c.value("instrument", nothing))}})
        if (!text.empty()) out_ << "  " << say_.of("campaign", name) << " " << text << "\n";
    if (!results.contains("certificate")) return;
    const Json& issued = results.at("certificate");
    if (issued.value("number", "").empty()) return;  // a draft has no number
    const std::string replaced = issued.value("replaces", ""), number = issued.value("number", "");
    out_ << "  " << say_("campaign.certificate") << " "
         << say_("certificate-of", {{"number", number}, {"date", issued.value("date", "")}})
         << (replaced.empty() ? "" : ", " + say_("replaces", {{"number", replaced}}))
         << (!folder_.empty() && is_out_of_force(folder_, number) ? ", " + say_("out-of-force")
                                                                  : "")
         << "\n";
  }

  void error(const Json& e) {
    Error error{e.value("message", ""), e.value("file", ""), e.value("line", std::uint64_t{0})};
    error.column = e.value("column", "");
    out_ << "\n" << paint(say_("error"), Colour::red) << "\n" << wrapped(text_of(error), 2, width_);
  }

  /// Returns the range of the targets (mm) that have a mean deviation, for example "0 to 1000 mm".
  /// Empty if they have fewer than two different positions.
  std::string range(const Json& a) const {
    const Json points = a.value("points", Json::array());
    const std::string unit = a.value("point_units", Json::object()).value("target", "");
    double least = INFINITY, most = -INFINITY;
    for (const Json& p : points) {
      if (!(p.contains("mean+") || p.contains("mean-")) || !p.contains("target")) continue;
      least = std::min(least, p.at("target").get<double>());
      most = std::max(most, p.at("target").get<double>());
    }
    if (unit.empty() || !(least < most)) return {};
    const auto text = [&](double x) {
      return local(evidence_text({"", x * 1e-3, Quantity::length}));
    };
    return say_("measurement.range", {{"from", text(least)}, {"to", text(most)}, {"unit", unit}});
  }

  std::string others(const Json& a) const {
    constexpr std::size_t most = 4;
    auto names = a.value("uses", std::vector<std::string>());
    const std::size_t more = names.size() > most ? names.size() - most : 0;
    names.resize(names.size() - more);
    return joined_text({joined_text(names, ", "),
                        more == 0 ? "" : say_("show.more", {{"count", std::to_string(more)}})},
                       " ");
  }

  void analysis(const Json& a, std::string& last) {
    const std::string measurement = a.value("measurement", "");
    const std::string of_several = others(a);
    if (!measurement.empty() && (measurement != last || !of_several.empty()))
      heading(of_several.empty()
                  ? joined_text({say_("measurement", {{"id", measurement}}), range(a)}, ", ")
                  : say_("measurements", {{"ids", measurement + ", " + of_several}}));
    last = of_several.empty() ? measurement : std::string();
    const Json& results = a.at("values");
    if (measurement.empty() && (all_ || !results.empty())) out_ << "\n";
    if (all_ || !results.empty())
      out_ << "  "
           << joined_text(
                  {a.at("plugin").get<std::string>(), a.value("version", ""), a.value("part", "")},
                  " ")
           << "\n";
    values(results, a.value("part", ""));
    collect(a, measurement);
    if (!all_) return;
    if (a.contains("series"))
      for (const auto& [name, s] : a.at("series").items()) series(name, s);
    if (a.contains("rows"))
      out_ << "    " << say_("rows", {{"count", std::to_string(a.at("rows").size())}}) << "\n";
    notes(a);
  }

  /// Rounds to the second significant digit of U. Without U, the value gets three decimals, or
  /// seven if it has no unit, such as a direction. Integers are not rounded; empty if the value is
  /// missing.
  std::string number(const Json& of, const char* key) const {
    if (!of.contains(key)) return {};
    const double value = of.at(key), U = of.value("U", 0.0);
    if (of.at(key).is_number_integer()) return std::to_string(of.at(key).get<std::int64_t>());
    if (!(U > 0.0) && of.value("unit", "").empty())
      return local(fixed_text(value, value == std::floor(value) ? 0 : 7));
    if (!(U > 0.0)) return local(fixed_text(value, 3));
    const auto rounded = rounded_result(value, U);
    if (!rounded) return local(short_text(value));
    if (key == std::string_view("U")) return local(rounded->U);
    // As many digits as show on which side of its tolerance limit the value is.
    std::string text = rounded->value;
    if (const auto limit = of.find("tolerance"); limit != of.end() && limit->is_number()) {
      const double most = limit->get<double>();
      const auto side = [&](double x) { return (std::fabs(x) > most) - (std::fabs(x) < most); };
      for (int digits = std::max(0, -place_of_second_digit(U));
           digits < 12 && side(std::strtod(text.c_str(), nullptr)) != side(value); ++digits)
        text = fixed_text(value, digits + 1);
    }
    return local(text);
  }

  /// Example: "4.8 ± 1.0 um". A value without U and unit is printed as a whole number or with
  /// four digits.
  std::string result(const Json& v) const {
    const std::string U = number(v, "U"), unit = v.value("unit", "");
    if (U.empty() && unit.empty() && v.at("value").is_number_float()) {
      const double plain = v.at("value");
      return local(plain == std::floor(plain) && std::fabs(plain) < 1e9 ? fixed_text(plain, 0)
                                                                        : short_text(plain, 4));
    }
    return joined_text({number(v, "value"), U.empty() ? "" : "± " + U, unit}, " ");
  }

  /// `part`: part of a model; that of a displacement over time has blocks of time instead of runs.
  void values(const Json& all, const std::string& part) {
    const auto name_of_value = [&](const std::string& name) {
      const bool is_over_time = name == "cv_rms" && part.find('/') != std::string::npos;
      return say_.of("value", is_over_time ? "cv_rms_over_time" : name);
    };
    std::vector<std::pair<std::string, Json>> rows, rest;
    for (const auto& [name, v] : all.items())
      (all_ || v.contains("decision") ? rows : rest).emplace_back(name, v);
    std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
      return rank_of(a.second) < rank_of(b.second);
    });
    for (auto& [name, v] : rows) name = name_of_value(name);
    table(rows);
    // Values of a single direction are shown only with --all, if the bidirectional value exists.
    std::erase_if(rest, [&](const auto& row) {
      return row.first.size() > 1 && (row.first.ends_with('+') || row.first.ends_with('-')) &&
             all.contains(row.first.substr(0, row.first.size() - 1));
    });
    std::erase_if(rest, [](const auto& row) {  // results of the test of a model
      return row.first.starts_with("lack_of_fit") || row.first == "redundancy";
    });
    std::string text;
    for (std::size_t i = 0; i < std::min(rest.size(), most_values); ++i)
      text +=
          (i == 0 ? "" : ", ") + glued(name_of_value(rest[i].first) + " " + result(rest[i].second));
    if (rest.size() > most_values)
      text += ", " + say_("show.more", {{"count", std::to_string(rest.size() - most_values)}});
    text = wrapped(text, 4, width_);
    std::replace(text.begin(), text.end(), glue, ' ');
    if (!rest.empty()) out_ << text;
  }

  static constexpr char glue = '\x1f';  // a space at which no line ends
  static std::string glued(std::string text) {
    std::replace(text.begin(), text.end(), ' ', glue);
    return text;
  }

  void table(const std::vector<std::pair<std::string, Json>>& rows) {
    if (rows.empty()) return;
    std::size_t name_width = 8, value_width = 8, U_width = 8, unit_width = 4;
    for (const auto& [name, v] : rows) {
      name_width = std::max(name_width, columns_of(name) + 1);
      value_width = std::max(value_width, number(v, "value").size());
      U_width = std::max(U_width, number(v, "U").size() + 1);
      unit_width = std::max(unit_width, v.value("unit", "").size());
    }
    const bool limits = rank_of(rows.front().second) != 3;
    out_ << "    " << padded("", name_width + 3) << padded_left(say_("value"), value_width)
         << padded_left("U", U_width) << "  "
         << (limits ? padded(say_("unit"), unit_width) + padded_left(say_("limit"), 11) + "  " +
                          say_("decision")
                    : say_("unit"))
         << "\n";
    constexpr const char* marks[] = {"!  ", "?  ", "ok ", "   "};
    for (const auto& [name, v] : rows) {
      const std::string decision = v.value("decision", ""), unit = v.value("unit", "");
      const std::string row = padded(name, name_width) +
                              padded_left(number(v, "value"), value_width) +
                              padded_left(number(v, "U"), U_width) + "  ";
      out_ << "    " << marks[rank_of(v)] << row;
      if (decision.empty()) {
        out_ << unit << "\n";
        continue;
      }
      std::string limit;
      append_shortest(limit, v.at("tolerance").get<double>());
      out_ << padded(unit, unit_width) << padded_left(local(limit), 11) << "  "
           << paint(say_.of("decision", decision), status_colour(decision)) << "\n";
    }
  }

  void series(const std::string& name, const Json& s) {
    double least = INFINITY, most = -INFINITY;
    for (const Json& v : s.at("value"))
      if (v.is_number()) {
        least = std::min(least, v.get<double>());
        most = std::max(most, v.get<double>());
      }
    if (!(least <= most)) return;
    out_ << "    " << padded(name + " ", 8)
         << say_("series", {{"over", s.value("over", "")},
                            {"low", local(fixed_text(least, 3))},
                            {"high", local(fixed_text(most, 3))},
                            {"unit", s.value("unit", "")}})
         << "\n";
  }

  void collect(const Json& of, const std::string& measurement) {
    if (!of.contains("findings")) return;
    for (const Json& json : of.at("findings")) {
      const Finding f = finding_of(json);
      const auto text = [&](const char* part) {
        return finding_text(say_.templates(), say_.language(), f, part);
      };
      const std::string severity = f.attention ? "attention" : "info", title = text("title");
      auto same = std::find_if(findings_.begin(), findings_.end(), [&](const Grouped& g) {
        return g.severity == severity && g.title == title;
      });
      if (same == findings_.end()) same = findings_.insert(same, {severity, title});
      const std::string where = f.measurement.empty() ? measurement : f.measurement;
      add_once(same->measurements, where);
      const std::string says = text("says");
      add_once(same->says, where.empty() || says.empty() ? says : where + ": " + says);
      add_once(same->advice, text("advice"));
    }
  }

  static bool is_of_one(const Grouped& g) {
    return g.says.size() == 1 && g.measurements.size() == 1 && !g.measurements.front().empty();
  }
  static std::string without_measurement(const Grouped& g) {
    return g.says.front().substr(g.measurements.front().size() + 2);
  }

  void sort_findings() {
    std::stable_partition(findings_.begin(), findings_.end(),
                          [](const Grouped& g) { return g.severity == "attention"; });
  }

  /// Prints only the titles of findings of severity info, unless --all is given.
  void findings() {
    if (findings_.empty()) return;
    heading(say_("findings"));
    for (const Grouped& g : findings_) {
      const bool is_warning = g.severity == "attention";
      const std::string severity = padded(say_.of("severity", g.severity), 9);
      const std::string where =
          g.measurements.empty() ? "" : " (" + storage::listed(g.measurements) + ")";
      out_ << "  " << (is_warning ? paint(severity, Colour::yellow) : severity)
           << wrapped(g.title + where, 11, width_).substr(11);
      if (!is_warning && !all_) continue;
      for (const std::string& says : g.says) {
        out_ << wrapped(is_of_one(g) ? without_measurement(g) : says, 11, width_);
      }
      for (const std::string& advice : g.advice)
        out_ << wrapped(say_("advice") + ": " + advice, 11, width_);
    }
  }

  void notes(const Json& of) {
    if (!of.contains("notes")) return;
    for (const Json& note : of.at("notes")) out_ << wrapped(note.get<std::string>(), 4, width_);
  }

  void undecided(const Json& all) {
    bool any = false;
    for (const Json& c : all) {
      if (c.value("decision", "") != "cannot be decided") continue;
      if (!std::exchange(any, true)) heading(say_("undecided"));
      const std::string reason = c.value("reason", ""),
                        why = words(say_.templates(), say_.language(), "results." + reason);
      const std::string axis = c.value("axis", ""), measurement = c.value("measurement", "");
      out_ << wrapped((axis.empty() ? "" : say_("head.axis") + " " + axis + ", ") +
                          (measurement.empty() || measurement == axis ? "" : measurement + ", ") +
                          c.value("name", "") + ": " + (why.empty() ? reason : why),
                      2, width_);
    }
  }

  void compensation(const Json& tables, const Json& written) {
    bool is_first = true;
    for (const Json& t : tables) {
      const std::string plugin = t.at("plugin");
      const auto files = std::count_if(written.begin(), written.end(), [&](const Json& o) {
        return o.value("plugin", "") == plugin;
      });
      if (files == 0 && !all_) continue;
      if (std::exchange(is_first, false)) heading(say_("compensation"));
      out_ << "  " << plugin << ": " << say_.counted("show.files", static_cast<std::size_t>(files))
           << "\n";
      std::string last;
      std::vector<std::string> parts;
      const auto flush = [&] {
        if (!parts.empty()) out_ << wrapped(last + ": " + joined_text(parts, ", "), 4, width_, 2);
        parts.clear();
      };
      for (const Json& p : t.value("predictions", Json::array())) {
        if (p.value("measurement", "") != last) flush();
        last = p.value("measurement", "");
        const auto three = [&](const char* key) {
          return local(short_text(p.at(key).get<double>(), 3));
        };
        parts.push_back(
            p.value("name", "") + " " +
            say_("predicted", {{"before", three("before")},
                               {"after", three("predicted")},
                               {"unit", p.value("unit", "")}}) +
            // A prediction is never below U.
            (three("before") == three("predicted") ? " (" + say_("not-below-U") + ")" : ""));
      }
      flush();
      if (all_)
        notes(t);
      else if (const std::size_t count = t.value("notes", Json::array()).size(); count > 0)
        out_ << "    " << say_("show.notes", {{"count", std::to_string(count)}}) << "\n";
    }
  }

  void outputs(const Json& results) {
    const Json& all = results.at("outputs");
    if (all_ && !all.empty()) heading(say_("files"));
    std::string report, draft;
    for (const Json& o : all) {
      const std::string file = o.at("file");
      if (all_) out_ << "  " << padded(file, 34) << " " << o.value("plugin", "") << "\n";
      if (report.empty() && file.starts_with("report") && file.ends_with(".pdf")) report = file;
      if (file == "certificate-draft.pdf") draft = file;
    }
    if (!draft.empty() && !folder_.empty())
      out_ << "\n" << say_("draft", {{"file", (fs::path(folder_) / draft).string()}}) << "\n";
    if (!report.empty() && !folder_.empty())
      out_ << "\n" << say_("report") << ": " << (fs::path(folder_) / report).string() << "\n";
    else if (!all_)
      out_ << "\n";
  }

  static constexpr std::size_t most_values = 8;  ///< limit per analysis without --all

  config::TerminalWords say_;
  bool all_;
  std::string folder_;
  std::ostream& out_;
  std::size_t width_;
  std::vector<Grouped> findings_{};
};

int show(const ShowWish& wish, const Common& common) {
  if (wish.opens) return open_document(wish.folder, wish.out, common);
  if (wish.folder.empty()) return complain("expected a campaign, its results, or a machine");
  const fs::path folder = results_at(wish.folder);
  const Holds holds = what_holds(folder);
  if (holds == Holds::nothing && !fs::exists(folder) && what_holds(wish.out) == Holds::run)
    return show_machine(wish.out, wish.folder, common);
  if (holds == Holds::run)
    return complain(folder.string() +
                    " contains the results of a run; choose a campaign, such as " +
                    (folder / "ID").string() + ", or use `nonio status " + folder.string() + "`");
  if (holds == Holds::nothing && !fs::exists(folder))
    return complain("\"" + folder.string() +
                    "\" is neither a folder nor a machine of the history in " + wish.out +
                    " (--out; `nonio machine list " + wish.out + "` lists the machines)");
  if (holds == Holds::nothing) return complain(holds_nothing(folder));
  const auto shown =
      holds == Holds::campaign ? evaluated_now(folder, common) : of_run(folder, common);
  if (!shown) return complain(text_of(shown.error()));
  const bool is_stored = holds == Holds::results && storage::stored_in(folder) == folder;
  try {
    const Json results = results_of(*shown);
    Page page(*shown, wish.all, is_stored ? folder.string() : "", std::cout);
    if (wish.only_findings)
      print_json(page.findings_json(results));
    else if (common.json)
      std::cout << shown->text;
    else
      page.print(results);
    return results.at("status") == "failed" ? exit_failed : exit_done;
  } catch (const Json::exception& e) {
    return complain((folder / evaluation::results_name).string() +
                    ": expected results of a campaign (nonio-results/1): " + e.what());
  }
}

}  // namespace

Verb show_verb(Common& common) {
  auto wish = std::make_shared<ShowWish>();
  using Takes = Argument::Takes;
  return {
      .name = "show",
      .summary = "Shows the results of a campaign, or the history of a machine",
      .arguments = joined(
          {takes(Takes::folder,
                 {"CAMPAIGN|OUT/ID|MACHINE", &wish->folder,
                  "A campaign (evaluated now, nothing is written), its results from a run, or the "
                  "name of a machine"}),
           {"--all", &wish->all, "All values, curves, findings with their texts, notes and files"},
           {"--findings", &wish->only_findings,
            "Only the findings as JSON, with their texts in the language of the results"},
           {"--open", &wish->opens,
            "Open the report on the desktop, or else the page or results.json, and print its path. "
            "Of a run: the first campaign that requires action. Without CAMPAIGN: what the current "
            "folder or --out contains"},
           takes(Takes::folder, {.name = "--out",
                                 .target = &wish->out,
                                 .help = "Output folder of `nonio run` with the machine or report",
                                 .shows_default = true}),
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Results with a tolerance come first: ! does not conform, ? indeterminate, ok "
          "conforms. A campaign requires action if a result does not conform or is indeterminate, "
          "or if a table or certificate was withheld. --json prints the text of "
          "results.json (of a machine: nonio-history/1).\n\n"
          "Exit status: 0 shown; 1 shown, and the campaign failed; 2 usage or configuration.",
      .examples = {"nonio show samples/site/09-tolerances", "nonio show out/09-tolerances --all",
                   "nonio show S-0042 --out out"},
      .run = [wish, &common] { return show(*wish, common); }};
}

}  // namespace nonio::app
