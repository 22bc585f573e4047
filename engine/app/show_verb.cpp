// SPDX-License-Identifier: Apache-2.0
// `nonio show`: results.json for a person at a terminal, read from a night's
// folder or made now.
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "campaign/config/template_files.h"
#include "campaign/config/terminal_words.h"
#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "campaign/reading/campaign_reader.h"
#include "colour.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "results_folder.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

struct ShowWish {
  std::string folder;
};

/// results.json and the words to say it in.
struct Shown {
  std::string text;
  Templates templates;
  std::string language = "en";
};

/// What the night would write, without a number drawn for a certificate;
/// nothing is written.
Expected<Shown> evaluated_now(const fs::path& folder, const Common& common) {
  auto place = reading::open_workplace(folder, common.plugin_folders(), common.template_folders(),
                                       NONIO_VERSION);
  if (!place) return fail(place.error());
  if (!common.quiet)
    for (const std::string& note : (*place)->notes) complain("nonio show", note);
  const reading::Context& context = (*place)->context;
  const evaluation::Evaluated evaluated =
      evaluation::evaluate(folder, id_of_campaign(folder), context, [](const std::string&) {});
  std::vector<evaluation::RecordedFile> files;
  for (const Results::Written& w : evaluated.results.outputs)
    for (const Artifact& a : w.result.artifacts)
      files.push_back({a.name, a.bytes.size(), storage::sha256(a.bytes)});
  std::string text = evaluation::results_json(evaluated, context, files);
  return Shown{std::move(text), std::move((*place)->context.templates), context.site.language};
}

Expected<Shown> of_night(const fs::path& folder, const Common& common) {
  auto text = storage::read_file(folder / evaluation::results_name);
  if (!text) return fail(text.error());
  std::string digest;
  auto templates = config::read_templates(common.template_folders(), digest);
  if (!templates) return fail(templates.error());
  Shown shown{std::move(*text), std::move(*templates)};
  if (const auto record = evaluation::read_record(folder); record && !record->language.empty())
    shown.language = record->language;
  return shown;
}

/// The number of a finding's evidence by its name with the unit: mean_um.
Number number_of(const std::string& key, const Json& value) {
  Number n{key, value.get<double>(),
           value.is_number_integer() ? Quantity::count
           : key == "p"              ? Quantity::probability
                                     : Quantity::number};
  std::size_t longest = 0;
  for (int i = 0; i <= static_cast<int>(Quantity::angle_per_kelvin); ++i) {
    const Unit unit = unit_of(static_cast<Quantity>(i));
    if (unit.suffix.size() <= longest || !key.ends_with(unit.suffix)) continue;
    longest = unit.suffix.size();
    n.quantity = static_cast<Quantity>(i);
  }
  n.name.resize(key.size() - longest);
  n.value /= unit_of(n.quantity).per_si;
  return n;
}

Finding finding_of(const Json& json) {
  Finding f{.id = json.at("id"), .attention = json.at("severity") == "attention"};
  for (const auto& [key, value] : json.at("evidence").items())
    if (value.is_string())
      f.texts.emplace_back(key, value.get<std::string>());
    else
      f.evidence.push_back(number_of(key, value));
  f.advice = json.value("advice", "");
  f.measurement = json.value("measurement", "");
  return f;
}

/// Columns of characters, not bytes.
std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string to_width(std::string text, std::size_t width, bool left = false) {
  const std::size_t has = columns_of(text);
  const std::string space(has < width ? width - has : 0, ' ');
  return left ? space + text : text + space;
}

class Page {
 public:
  Page(const Shown& shown, std::ostream& out) : say_(shown.templates, shown.language), out_(out) {
    winsize size{};
    const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col != 0;
    width_ = known ? std::clamp<std::size_t>(size.ws_col, 80, 120) : 80;
  }

  void print(const Json& results) {
    head(results);
    for (const Json& e : results.at("errors")) error(e);
    std::vector<std::string> seen;
    for (const Json& a : results.at("analyses")) analysis(a, seen);
    if (results.contains("conformity")) undecided(results.at("conformity"));
    if (results.contains("tables"))
      for (const Json& t : results.at("tables")) table(t);
    notes(results, "");
    outputs(results);
  }

 private:
  static std::string paint(const std::string& text, Colour colour) {
    return coloured(text, colour, STDOUT_FILENO);
  }
  void heading(const std::string& text) { out_ << "\n" << paint(text, Colour::bold) << "\n"; }

  void wrapped(const std::string& indent, const std::string& text) {
    std::string line = indent;
    std::size_t used = indent.size();
    for (std::size_t i = 0; i < text.size();) {
      const std::size_t end = std::min(text.find(' ', i), text.size());
      const std::string word = text.substr(i, end - i);
      if (used > indent.size() && used + 1 + columns_of(word) > width_) {
        out_ << line << "\n";
        line = indent;
        used = indent.size();
      }
      if (used > indent.size()) line += ' ';
      used += columns_of(word) + (used > indent.size() ? 1 : 0);
      line += word;
      i = end + 1;
    }
    out_ << line << "\n";
  }

  void entry(const std::string& name, const std::string& text) {
    if (!text.empty()) out_ << "  " << to_width(say_.of("campaign", name), 12) << text << "\n";
  }

  void head(const Json& results) {
    const Json& c = results.at("campaign");
    const std::string status = results.at("status");
    out_ << paint(c.at("id").get<std::string>(), Colour::bold) << "  "
         << paint(say_.of("status", status), status_colour(status)) << "\n";
    for (const char* name : {"customer", "site", "date", "operator"})
      entry(name, c.value(name, ""));
    for (const char* name : {"machine", "instrument"}) {
      std::string text;
      if (c.contains(name))
        for (const char* part : {"maker", "model", "serial"})
          if (const std::string word = c.at(name).value(part, ""); !word.empty())
            text += (text.empty() ? "" : " ") + word;
      entry(name, text);
    }
    if (!results.contains("certificate")) return;
    const Json& issued = results.at("certificate");
    const std::string replaced = issued.value("replaces", "");
    entry("certificate",
          say_("certificate-of",
               {{"number", issued.value("number", "")}, {"date", issued.value("date", "")}}) +
              (replaced.empty() ? "" : ", " + say_("replaces", {{"number", replaced}})));
  }

  void error(const Json& e) {
    Error error{e.value("message", ""), e.value("file", ""), e.value("line", std::uint64_t{0})};
    error.column = e.value("column", "");
    out_ << "\n" << paint(say_("error"), Colour::red) << "\n";
    wrapped("  ", text_of(error));
  }

  void analysis(const Json& a, std::vector<std::string>& seen) {
    const std::string measurement = a.value("measurement", "");
    if (!measurement.empty() && std::find(seen.begin(), seen.end(), measurement) == seen.end()) {
      heading(say_("measurement", {{"id", measurement}}));
      seen.push_back(measurement);
    }
    const std::string name = a.at("plugin").get<std::string>() + " " + a.value("version", "");
    measurement.empty() ? heading(name) : void(out_ << "  " << name << "\n");
    values(a.at("values"));
    if (a.contains("series"))
      for (const auto& [series_name, s] : a.at("series").items()) series(series_name, s);
    if (a.contains("rows"))
      out_ << "    " << say_("rows", {{"count", std::to_string(a.at("rows").size())}}) << "\n";
    for (const Json& f : a.at("findings")) finding(f, measurement);
    notes(a, "  ");
  }

  /// To the second significant digit of U. Without one to three decimals, of what has no unit (a
  /// direction) to seven.
  static std::string number(const Json& of, const char* key) {
    if (!of.contains(key)) return {};
    const double value = of.at(key), U = of.value("U", 0.0);
    if (of.at(key).is_number_integer()) return std::to_string(of.at(key).get<std::int64_t>());
    if (!(U > 0.0)) return fixed_text(value, of.value("unit", "").empty() ? 7 : 3);
    return fixed_text(value, std::clamp(1 - static_cast<int>(std::floor(std::log10(U))), 0, 12));
  }

  static std::string shortest(double value) {
    std::string text;
    append_shortest(text, value);
    return text;
  }

  void values(const Json& all) {
    if (all.empty()) return;
    bool limits = false;
    std::size_t name_width = 8, value_width = 12, U_width = 10;
    for (const auto& [name, v] : all.items()) {
      limits = limits || v.contains("decision");
      name_width = std::max(name_width, columns_of(name) + 1);
      value_width = std::max(value_width, number(v, "value").size());
      U_width = std::max(U_width, number(v, "U").size() + 1);
    }
    out_ << "    " << to_width("", name_width) << to_width(say_("value"), value_width, true)
         << to_width("U", U_width, true) << "  "
         << (limits ? to_width(say_("unit"), 10) + to_width(say_("limit"), 9, true) + "  " +
                          say_("decision")
                    : say_("unit"))
         << "\n";
    for (const auto& [name, v] : all.items()) {
      out_ << "    " << to_width(name, name_width)
           << to_width(number(v, "value"), value_width, true)
           << to_width(number(v, "U"), U_width, true) << "  ";
      const std::string unit = v.value("unit", ""), decision = v.value("decision", "");
      if (decision.empty())
        out_ << unit << "\n";
      else
        out_ << to_width(unit, 10) << to_width(shortest(v.at("tolerance").get<double>()), 9, true)
             << "  " << paint(say_.of("decision", decision), status_colour(decision)) << "\n";
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
    out_ << "    " << to_width(name + " ", 8)
         << say_("series", {{"over", s.value("over", "")},
                            {"low", fixed_text(least, 3)},
                            {"high", fixed_text(most, 3)},
                            {"unit", s.value("unit", "")}})
         << "\n";
  }

  std::string said_of(const Finding& f, const char* part) const {
    return finding_text(say_.templates(), say_.language(), f, part);
  }

  /// Two analyses of one measurement may find the same.
  void finding(const Json& json, const std::string& measurement) {
    const Finding f = finding_of(json);
    const bool again = !told_.insert(measurement + "\n" + json.dump()).second;
    if (again && !f.attention) return;
    const std::string of = f.measurement.empty() ? "" : f.measurement + ": ";
    out_ << "    "
         << (f.attention ? paint(to_width(say_("severity.attention"), 9), Colour::yellow)
                         : to_width(say_("severity.info"), 9))
         << "  " << of << said_of(f, "title") << (again ? ": " + say_("as-above") : "") << "\n";
    if (again) return;
    if (const std::string says = said_of(f, "says"); !says.empty())
      wrapped("               ", says);
    if (const std::string advice = said_of(f, "advice"); !advice.empty())
      wrapped("               ", say_("advice") + ": " + advice);
  }

  void notes(const Json& of, const std::string& indent) {
    if (!of.contains("notes")) return;
    if (indent.empty()) heading(say_("notes"));
    for (const Json& note : of.at("notes")) wrapped(indent + "  ", note.get<std::string>());
  }

  void undecided(const Json& all) {
    bool any = false;
    for (const Json& c : all) {
      if (c.value("decision", "") != "cannot be decided") continue;
      if (!std::exchange(any, true)) heading(say_("undecided"));
      const std::string reason = c.value("reason", ""),
                        why = words(say_.templates(), say_.language(), "results." + reason);
      out_ << "  " << say_("head.axis") << " " << c.value("axis", "") << ", " << c.value("name", "")
           << ": " << (why.empty() ? reason : why) << "\n";
    }
  }

  void table(const Json& t) {
    heading(t.at("plugin").get<std::string>() + " " + t.value("version", ""));
    if (t.contains("predictions"))
      for (const Json& p : t.at("predictions"))
        out_ << "    " << p.value("measurement", "") << ", " << p.value("name", "") << ": "
             << say_("predicted", {{"before", fixed_text(p.at("before").get<double>(), 3)},
                                   {"after", fixed_text(p.at("predicted").get<double>(), 3)},
                                   {"unit", p.value("unit", "")}})
             << "\n";
    if (t.contains("findings"))
      for (const Json& f : t.at("findings")) finding(f, "");
    notes(t, "  ");
  }

  void outputs(const Json& results) {
    if (results.at("outputs").empty()) return;
    heading(say_("files"));
    for (const Json& o : results.at("outputs"))
      out_ << "  " << to_width(o.at("file"), 34) << " " << o.value("plugin", "") << "\n";
  }

  config::TerminalWords say_;
  std::ostream& out_;
  std::size_t width_ = 80;
  std::set<std::string> told_{};
};

int show(const ShowWish& wish, const Common& common) {
  const char* const verb = "nonio show";
  const fs::path folder = results_at(wish.folder);
  const Holds holds = what_holds(folder);
  if (holds == Holds::night)
    return complain(verb, folder.string() + " holds the results of a night; expected " +
                              (folder / "ID").string() + " (summary.txt lists them)");
  if (holds == Holds::nothing) return complain(verb, holds_nothing(folder));
  const auto shown =
      holds == Holds::campaign ? evaluated_now(folder, common) : of_night(folder, common);
  if (!shown) return complain(verb, text_of(shown.error()));
  try {
    const Json results = Json::parse(shown->text);
    if (common.json)
      std::cout << shown->text;
    else
      Page(*shown, std::cout).print(results);
    return results.at("status") == "failed" ? exit_failed : exit_done;
  } catch (const Json::exception& e) {
    return complain(verb, (folder / evaluation::results_name).string() +
                              ": expected results of a campaign (nonio-results/1): " + e.what());
  }
}

}  // namespace

Verb show_verb(Common& common) {
  auto wish = std::make_shared<ShowWish>();
  return {.name = "show",
          .summary = "Shows values, decisions and findings of one campaign in the terminal",
          .arguments = joined({required(takes(Argument::Takes::folder,
                                              {"CAMPAIGN|OUT/ID", &wish->folder,
                                               "A campaign (evaluated now, nothing is written), "
                                               "or its results from a nightly run"})),
                               templates_argument(common)},
                              common_arguments(common)),
          .footer =
              "--json prints the text of results.json.\n\n"
              "Exit status: 0 shown; 1 shown, and the campaign failed; 2 usage or "
              "configuration.\n\n"
              "Examples: nonio show samples/site/09-tolerances\n"
              "          nonio show out/09-tolerances",
          .run = [wish, &common] { return show(*wish, common); }};
}

}  // namespace nonio::app
