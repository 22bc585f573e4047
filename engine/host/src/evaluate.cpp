// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/evaluate.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "names.h"
#include "nonio/host/digest.h"
#include "nonio/host/files.h"
#include "nonio/host/nearest.h"
#include "nonio/sdk/format.h"

namespace nonio::host {
namespace fs = std::filesystem;

namespace {

/// Nobody throws on purpose; whatever a plugin does throw ends here, with its name.
template <class Call>
auto guarded(const std::string& who, const Call& call) -> decltype(call()) {
  try {
    auto result = call();
    if (!result) result.error().message = who + ": " + result.error().message;
    return result;
  } catch (const std::bad_alloc&) {
    return fail(who + ": out of memory (the limit for one campaign is in site.toml, [limits])");
  } catch (const std::exception& e) {
    return fail(who + " threw an exception: " + e.what());
  } catch (...) {
    return fail(who + " threw an exception of an unknown kind");
  }
}

class CampaignRun {
 public:
  CampaignRun(const fs::path& folder, const Context& context, const Stage& stage)
      : folder_(folder), context_(context), stage_(stage) {}

  Evaluated run(const std::string& id) {
    id_ = out_.campaign.id = id;
    if (read_manifest()) {
      read_measurements();
      analyse();
      if (!failed()) hold_against_tolerances();
      fill_advice();
      if (!failed()) write_outputs();
    }
    out_.status = failed() ? "failed" : needs_attention() ? "attention" : "ok";
    return std::move(out_);
  }

 private:
  bool failed() const { return !out_.results.errors.empty(); }
  void report(Error error) { out_.results.errors.push_back(std::move(error)); }
  void locate(Error& error, const std::string& plugin = {}) const {
    host::locate(error, manifest_.lines, context_.site.lines, plugin);
  }
  /// An error that a key of the manifest is to blame for.
  Error at(std::string key, const std::string& message) const {
    Error error{key + ": " + message};
    error.key = std::move(key);
    locate(error);
    return error;
  }

  bool read_manifest() {
    stage_("reading campaign.toml");
    const auto text = read_file(folder_ / manifest_name);
    if (!text) {
      report(Error{text.error().message, manifest_name});
      return false;
    }
    out_.inputs.emplace_back(manifest_name, sha256(*text));
    auto manifest = parse_manifest(*text, manifest_name);
    if (!manifest) {
      out_.results.errors = std::move(manifest.error());
      return false;
    }
    out_.campaign = std::move(manifest->campaign);
    out_.campaign.laboratory = context_.site.laboratory;
    manifest_ = std::move(*manifest);
    if (out_.campaign.id != id_) {
      report(Error{"the id changed while the campaign was read", manifest_name});
      out_.campaign.id = id_;
    }
    return !failed();
  }

  void read_measurements() {
    observations_.resize(out_.campaign.measurements.size());
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const Measurement& m = out_.campaign.measurements[i];
      auto read = read_measurement(m, observations_[i]);
      if (read) continue;
      if (read.error().file.empty()) read.error().file = m.file;
      report(std::move(read.error()));
    }
  }

  Expected<void> read_measurement(const Measurement& m, Observations& into) {
    const auto path = path_inside(folder_, m.file);
    const auto file = path ? MappedFile::open(*path) : fail(path.error());
    note_input(m.file, file ? sha256(file->bytes()) : absent);
    if (!path) return fail(at("measurement." + m.id + ".file", path.error().message));
    if (!file) return fail(at("measurement." + m.id + ".file", file.error().message));
    const auto reader = choose_reader(m, file->bytes());
    if (!reader) return fail(reader.error());
    if (*reader == nullptr) return {};
    const Info& info = (*reader)->info;
    const auto options = settle(info);
    if (!options) return {};
    const std::string who = "reader " + info.name;
    stage_(who + " (measurement " + m.id + ")");
    auto observations = guarded(who, [&] {
      return (*reader)->read({file->bytes(), out_.campaign, m, *options,
                              [&](std::size_t offset) { file->release(offset); }});
    });
    if (!observations) {
      Error error = observations.error();
      if (error.message.starts_with(who + ": ")) error.message.erase(0, who.size() + 2);
      return fail(std::move(error));
    }
    if (auto sound = check(*observations); !sound)
      return fail(who + " gave " + sound.error().message);
    into = std::move(*observations);
    word(into.notes);
    for (Remark note : into.notes) {
      note.measurement = m.id;
      out_.results.notes.push_back(std::move(note));
    }
    return {};
  }

  void note_input(const std::string& name, const std::string& digest_now) {
    for (const auto& [known, digest] : out_.inputs)
      if (known == input_name(name)) return;
    out_.inputs.emplace_back(input_name(name), digest_now);
  }

  /// The reader that is named, or the first that knows the content; none if no plugin reads this
  /// kind of measurement at all, which is noted and leaves the others to be evaluated.
  Expected<const Reader*> choose_reader(const Measurement& m, std::string_view bytes) {
    const auto& readers = context_.plugins->readers();
    if (!m.reader.empty()) {
      for (const Reader& r : readers)
        if (r.info.name == m.reader) return &r;
      return fail(
          at("measurement." + m.id + ".reader", context_.plugins->absence("reader", m.reader)));
    }
    bool any = false;
    if (bytes.find_first_not_of(" \t\r\n") == bytes.npos)
      return fail(Error{"expected readings, found an empty file", m.file});
    for (const Reader& r : readers) {
      if (!r.reads(m.kind)) continue;
      any = true;
      if (r.recognises(bytes.substr(0, 4096))) return &r;
    }
    if (any)
      return fail(
          Error{"no reader knows the format of this file; wanted a CSV with a header row, or "
                "the format of an installed reader (`nonio plugins`)",
                m.file});
    unread_.push_back(m.id);
    out_.results.notes.push_back({"measurement.unread", {}, {{"kind", m.kind}}, m.id});
    word(out_.results.notes);
    return nullptr;
  }

  /// What every later stage relies on, whatever the reader did.
  static Expected<void> check(const Observations& o) {
    const std::size_t n = o.size();
    const auto fits = [n](const auto& column) { return column.empty() || column.size() == n; };
    bool sound = fits(o.u) && fits(o.run) && fits(o.line) && fits(o.source_line) && fits(o.time) &&
                 fits(o.material) && fits(o.air) && fits(o.pressure) && fits(o.humidity);
    for (const auto& axis : o.axes)
      sound = sound && axis.position.size() == n && fits(axis.approach);
    if (!sound) return fail("columns of different lengths");
    const auto finite = [](double x) { return std::isfinite(x); };
    if (!std::all_of(o.deviation.begin(), o.deviation.end(), finite))
      return fail("a deviation that is not a number");
    for (const auto& axis : o.axes)
      if (!std::all_of(axis.position.begin(), axis.position.end(), finite))
        return fail("a position that is not a number");
    return {};
  }

  std::optional<Settings> settle(const Info& info) {
    auto options = settle_options(info, context_.site.options, manifest_.options);
    if (options) return std::move(*options);
    for (Error& e : options.error()) report(std::move(e));
    return std::nullopt;
  }

  /// The plugins that are asked for, or all; a name that is not there is an error.
  template <class Plugin>
  std::vector<const Plugin*> chosen(const std::vector<Plugin>& all, const char* kind,
                                    const char* key,
                                    const std::optional<std::vector<std::string>>& campaign,
                                    const std::optional<std::vector<std::string>>& site) {
    std::vector<const Plugin*> out;
    const auto& names = campaign ? campaign : site;
    if (!names) {
      for (const Plugin& p : all) out.push_back(&p);
      return out;
    }
    for (const std::string& name : *names) {
      const auto found = std::find_if(all.begin(), all.end(),
                                      [&](const Plugin& p) { return p.info.name == name; });
      if (found == all.end())
        report(at(key, context_.plugins->absence(kind, name)));
      else if (std::find(out.begin(), out.end(), &*found) == out.end())
        out.push_back(&*found);
    }
    return out;
  }

  void analyse() {
    const auto analyses = chosen(context_.plugins->analyses(), "analysis", "run.analyses",
                                 manifest_.run.analyses, context_.site.run.analyses);
    for (Error& e : ownerless_options(manifest_.options, *context_.plugins)) report(std::move(e));
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const Measurement& m = out_.campaign.measurements[i];
      if (observations_[i].size() == 0) continue;
      for (const Analysis* analysis : analyses) {
        if (!analysis->applies(out_.campaign, m)) continue;
        const auto options = settle(analysis->info);
        if (!options) continue;
        const std::string who = "analysis " + analysis->info.name;
        stage_(who + " (measurement " + m.id + ")");
        auto evaluation = guarded(who, [&] {
          return analysis->analyse({out_.campaign, m, observations_[i], *options});
        });
        if (evaluation)
          if (auto sound = check(*evaluation); !sound)
            evaluation = fail(who + " gave " + sound.error().message);
        if (!evaluation) {
          locate(evaluation.error(), analysis->info.name);
          if (evaluation.error().file.empty()) evaluation.error().file = m.file;
          report(std::move(evaluation.error()));
          continue;
        }
        for (Finding& f : evaluation->findings) f.measurement = m.id;
        word(evaluation->notes);
        out_.results.analyses.push_back(
            {analysis->info.name, analysis->info.version, m.id, std::move(*evaluation)});
      }
    }
  }

  static Expected<void> check(const Evaluation& e) {
    for (const Value& v : e.values)
      if (!std::isfinite(v.value) || (v.U && !std::isfinite(*v.U)))
        return fail("a value " + v.name + " that is not a number");
    for (const Finding& f : e.findings)
      for (const Number& n : f.evidence)
        if (!std::isfinite(n.value))
          return fail("evidence " + n.name + " of finding " + f.id + " that is not a number");
    for (const PointTable::Column& c : e.points.columns)
      if (c.values.size() != e.points.columns.front().values.size())
        return fail("a table of points with columns of different lengths");
    for (const Series& s : e.series)
      if (s.value.size() != s.position.size() || (!s.U.empty() && s.U.size() != s.value.size()))
        return fail("a series " + s.name + " with columns of different lengths");
    return {};
  }

  void hold_against_tolerances() {
    for (const Axis& axis : out_.campaign.machine.axes)
      for (const auto& [name, tolerance] : axis.tolerance) {
        bool found = false;
        for (const Measurement& m : out_.campaign.measurements)
          if (m.axis == axis.name && m.kind == "axis") found |= hold(axis, m.id, name, tolerance);
        if (!found)
          out_.results.conformity.push_back({"", axis.name, "", name, tolerance,
                                             deviation_of(axis.rotary), Decision::cannot_be_decided,
                                             "no-value"});
      }
  }

  bool hold(const Axis& axis, const std::string& measurement, const std::string& name,
            double tolerance) {
    bool found = false;
    for (const Results::Analysed& a : out_.results.analyses)
      for (const Value& v : a.evaluation.values) {
        if (a.measurement != measurement || v.name != name) continue;
        Conformity c{.measurement = measurement,
                     .axis = axis.name,
                     .plugin = a.plugin,
                     .name = name,
                     .tolerance = tolerance,
                     .quantity = v.quantity,
                     .decision = Decision::cannot_be_decided,
                     .reason = {}};
        if (v.U) {
          c.decision = decide(std::fabs(v.value), *v.U, tolerance);
          if (c.decision == Decision::cannot_be_decided) c.reason = "near-limit";
        } else {
          c.reason = "no-uncertainty";
        }
        out_.results.conformity.push_back(std::move(c));
        found = true;
      }
    return found;
  }

  void word(std::vector<Remark>& notes) const {
    for (Remark& note : notes) note.english = remark_text(context_.templates, "en", note);
  }

  /// results.json speaks English; documents look the words up in their own language.
  void fill_advice() {
    for (Results::Analysed& a : out_.results.analyses)
      for (Finding& f : a.evaluation.findings)
        f.advice = finding_text(context_.templates, "en", f, "advice");
  }

  void write_outputs() {
    auto outputs = chosen(context_.plugins->outputs(), "output", "run.outputs",
                          manifest_.run.outputs, context_.site.run.outputs);
    const bool all = !manifest_.run.outputs && !context_.site.run.outputs;
    check_control();
    if (failed()) return;
    std::stable_partition(outputs.begin(), outputs.end(),
                          [](const Output* o) { return o->stage == Output::Stage::table; });
    for (const Output* output : outputs) {
      const std::string& control = out_.campaign.machine.control;
      if (all && output->stage == Output::Stage::table && !control.empty() &&
          control != output->info.name)
        continue;
      if (!output->applies(out_.campaign)) continue;
      const bool asked =
          !all || output->stage != Output::Stage::table || control == output->info.name;
      if (const auto options = settle(output->info)) write_output(*output, *options, asked);
    }
  }

  void check_control() {
    const std::string& control = out_.campaign.machine.control;
    std::vector<std::string> tables;
    for (const Output& o : context_.plugins->outputs())
      if (o.stage == Output::Stage::table) tables.push_back(o.info.name);
    if (control.empty() || std::find(tables.begin(), tables.end(), control) != tables.end()) return;
    std::string list;
    for (const std::string& name : tables) list += (list.empty() ? "" : ", ") + name;
    report(at("machine.control", "no output writes tables for \"" + control + "\"" +
                                     suggestion(control, tables) + "; there are " + list));
  }

  /// Without `asked` a table that the control cannot have is worth a finding, not the campaign: it
  /// was tried only because nobody said which control the machine has.
  void write_output(const Output& output, const Settings& options, bool asked) {
    const std::string who = "output " + output.info.name;
    stage_(who);
    auto result = guarded(who, [&] {
      auto written =
          output.write({out_.campaign, observations_, out_.results, options, context_.templates});
      if (!written && !asked && written.error().key.empty()) {
        const std::string why = std::move(written.error().message);
        written = OutputResult();
        written->findings.push_back({.id = "table.not-written",
                                     .attention = true,
                                     .texts = {{"output", output.info.name}, {"why", why}}});
      }
      return written;
    });
    if (result)
      if (auto sound = check(*result); !sound)
        result = fail(who + " gave " + sound.error().message);
    if (!result) {
      locate(result.error(), output.info.name);
      return report(std::move(result.error()));
    }
    word(result->notes);
    for (Finding& f : result->findings)
      f.advice = finding_text(context_.templates, "en", f, "advice");
    for (const Artifact& a : result->artifacts) names_.insert(a.name);
    out_.results.outputs.push_back({output.info.name, output.info.version, std::move(*result)});
  }

  Expected<void> check(const OutputResult& result) const {
    std::set<std::string> own;
    for (const Artifact& a : result.artifacts) {
      if (!is_artifact_name(a.name))
        return fail("the file name \"" + a.name +
                    "\": wanted a plain name inside the output folder");
      if (names_.contains(a.name) || !own.insert(a.name).second)
        return fail("the file name \"" + a.name + "\", which is already taken");
    }
    for (const Prediction& p : result.predictions)
      if (!std::isfinite(p.before) || !std::isfinite(p.after))
        return fail("a prediction of " + p.name + " that is not a number");
    for (const Finding& f : result.findings)
      for (const Number& n : f.evidence)
        if (!std::isfinite(n.value))
          return fail("evidence " + n.name + " of finding " + f.id + " that is not a number");
    return {};
  }

  bool needs_attention() const {
    const auto asks = [](const std::vector<Finding>& findings) {
      return std::any_of(findings.begin(), findings.end(),
                         [](const Finding& f) { return f.attention; });
    };
    return !unread_.empty() ||
           std::any_of(out_.results.analyses.begin(), out_.results.analyses.end(),
                       [&](const auto& a) { return asks(a.evaluation.findings); }) ||
           std::any_of(out_.results.outputs.begin(), out_.results.outputs.end(),
                       [&](const auto& o) { return asks(o.result.findings); }) ||
           std::any_of(out_.results.conformity.begin(), out_.results.conformity.end(),
                       [](const Conformity& c) { return c.decision != Decision::conforms; });
  }

  const fs::path& folder_;
  const Context& context_;
  const Stage& stage_;
  std::string id_;
  Evaluated out_;
  Manifest manifest_;
  std::vector<Observations> observations_;
  std::vector<std::string> unread_;
  std::set<std::string> names_;
};

}  // namespace

Decision decide(double value, double U, double tolerance) {
  if (value <= tolerance - U) return Decision::conforms;
  if (value > tolerance + U) return Decision::does_not_conform;
  return Decision::cannot_be_decided;
}

std::string input_name(const std::string& file) { return "file " + file; }

Inputs shared_inputs(const Context& context) {
  return {{"site.toml", context.site_sha256},
          {"plugins", context.plugins_sha256},
          {"templates", context.templates_sha256},
          {"version", context.version}};
}

Evaluated evaluate(const fs::path& folder, const std::string& id, const Context& context,
                   const Stage& stage) {
  return CampaignRun(folder, context, stage).run(id);
}

}  // namespace nonio::host
