// SPDX-License-Identifier: Apache-2.0
// An output of one text, a table of a control, and their faults.
#include <stdexcept>

#include "nonio/controllers/list.h"
#include "spoiled.h"

namespace {

using namespace nonio;
using spoiled::has;

OutputResult file(const std::string& name, const std::string& bytes) {
  OutputResult r;
  r.artifacts.push_back({name, bytes, false});
  return r;
}

std::string text_of(const OutputInput& in) {
  const int extra = static_cast<int>(spoiled::impurity() + spoiled::counted());
  return in.campaign.id + " " + std::to_string(extra) + "\n";
}

[[maybe_unused]] Expected<OutputResult> write_text(const OutputInput& in) {
  if (has("refuses-all")) return fail("expected something else");
  if (has("throws")) throw std::runtime_error("wrong on purpose");
  if (has("writes-nothing")) return OutputResult{};
  if (has("crashes-without-results") && in.results.analyses.empty()) spoiled::crash();
  if (has("crashes-without-readings"))
    for (const Observations& o : in.observations)
      if (o.size() == 0) spoiled::crash();
  if (has("crashes-at-long-texts") && in.campaign.customer.size() > 5000) spoiled::crash();
  if (has("named-by-machine")) return file("of-" + in.campaign.machine.model + ".txt", "a");
  if (has("named-by-customer")) return file("for " + in.campaign.customer + ".txt", "a");
  if (has("into-a-folder")) return file("tables/a.txt", "a");
  if (has("above")) return file("../a.txt", "a");
  if (has("absolute")) return file("/tmp/a.txt", "a");
  if (has("without-name")) return file("", "a");
  if (has("no-json")) return file("a.json", "{\"a\": 1,}");
  if (has("path-by-choice") && in.options.text("kind") == "b") return file("../a.txt", "a");
  if (has("crashes-by-choice") && in.options.text("kind") == "b") spoiled::crash();
  if (has("crashes-at-the-end") && in.options.number("size", 0.0) > 9.0) spoiled::crash();
  OutputResult r = file("a.txt", text_of(in));
  if (has("twice-the-same")) r.artifacts.push_back(r.artifacts.front());
  if (has("prediction-of-nan")) {
    Prediction p{};
    p.name = "E";
    p.before = p.after = spoiled::nan;
    r.predictions.push_back(p);
  }
  if (has("evidence-of-nan")) {
    Finding f{.id = "found"};
    f.evidence.push_back({"x", spoiled::nan, Quantity::deviation});
    r.findings.push_back(f);
  }
  return r;
}

// ---- a table

ControlTable declared() {
  ControlTable t;
  t.name = has("without-a-name") ? "" : "spoiled";
  t.sign = ControlTable::Sign::correction;
  t.position_step = {1e-6, 1e-4 / deg_per_rad};
  t.value_step = {1e-6, 1e-3 / deg_per_rad};
  t.bidirectional = true;
  t.facts = {{"sign", ControlTable::Confidence::documented, "Wrong on purpose."}};
  if (has("without-facts")) t.facts.clear();
  if (has("fact-twice")) t.facts.push_back(t.facts.front());
  if (has("fact-without-words")) t.facts.front().description = "";
  if (has("step-of-zero")) t.value_step.linear = 0.0;
  if (has("step-of-nan")) t.position_step.rotary = spoiled::nan;
  if (has("increments-of-nothing")) t.increment = {5, 5};
  return t;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  if (has("unreadable")) return fail("expected a table");
  if (has("reads-nothing")) return std::vector<LoadedTable>();
  auto tables =
      controllers::parse_list(in, declared(), "spoiled",
                              in.files.front().bytes.find(" entry_minus") != std::string::npos
                                  ? controllers::Columns::both
                                  : controllers::Columns::mean);
  if (!tables) return tables;
  for (LoadedTable& t : *tables) {
    const auto entries = [&](const auto& change) {
      for (double& v : t.plus) v = change(v);
      for (double& v : t.minus) v = change(v);
    };
    if (has("reads-x1000")) entries([](double v) { return 1e3 * v; });
    if (has("reads-tenths")) entries([](double v) { return 0.1 * v; });
    if (has("reads-inches")) entries([](double v) { return 25.4 * v; });
    if (has("reads-the-other-sign")) entries([](double v) { return -v; });
    if (has("reads-increments"))
      for (std::size_t i = 1; i < t.plus.size(); ++i) t.plus[i] += t.plus[i - 1];
    auto& x = t.position.front();
    if (has("reads-places-in-m"))
      for (double& p : x) p *= 1e3;
    if (has("reads-places-from-the-first"))
      for (double& p : x) p += 0.05;
    if (has("reads-without-the-last") && x.size() > 2) {
      x.pop_back(), t.plus.pop_back();
      if (!t.minus.empty()) t.minus.pop_back();
    }
    if (has("reads-without-the-first") && x.size() > 2) {
      x.erase(x.begin()), t.plus.erase(t.plus.begin());
      if (!t.minus.empty()) t.minus.erase(t.minus.begin());
    }
    if (has("reads-the-next-entry")) std::rotate(t.plus.begin(), t.plus.begin() + 1, t.plus.end());
    if (has("reads-backwards")) std::reverse(t.plus.begin(), t.plus.end());
  }
  return tables;
}

/// The file is spoiled; the reader of the file is correct.
Expected<std::vector<Artifact>> files(const controllers::Sheet& given) {
  controllers::Sheet s = given;
  const auto both = [&](const auto& change) {
    for (auto* v : {&s.plus, &s.minus})
      for (double& x : *v) x = change(x);
  };
  const auto minus = [&](const auto& change) {
    for (double& x : s.minus) x = change(x);
  };
  if (has("writes-the-error")) both([](double x) { return -x; });
  if (has("writes-twice-as-much")) both([](double x) { return 2.0 * x; });
  if (has("writes-half-of-it")) both([](double x) { return 0.5 * x; });
  if (has("writes-a-tenth")) both([](double x) { return 0.1 * x; });
  if (has("writes-inches")) both([](double x) { return x / 25.4; });
  if (has("writes-increments"))
    for (std::size_t i = s.plus.size(); i-- > 1;) s.plus[i] -= s.plus[i - 1];
  if (has("writes-backwards"))
    std::reverse(s.plus.begin(), s.plus.end()), std::reverse(s.minus.begin(), s.minus.end());
  if (has("writes-one-point-later")) {
    for (std::size_t i = s.plus.size(); i-- > 1;) s.plus[i] = s.plus[i - 1];
    for (std::size_t i = s.minus.size(); i-- > 1;) s.minus[i] = s.minus[i - 1];
  }
  if (has("cuts-digits-off")) both([](double x) { return std::trunc(x * 1e6) * 1e-6; });
  if (has("rounds-away"))
    both([](double x) { return (x > 0.0 ? std::ceil(x * 1e6) : std::floor(x * 1e6)) * 1e-6; });
  if (has("rounds-coarsely")) both([](double x) { return std::round(x * 2e5) / 2e5; });
  if (has("wraps-at-a-byte")) both([](double x) { return std::remainder(x, 256e-6); });
  if (has("clips-large-ones")) both([](double x) { return std::clamp(x, -2e-4, 2e-4); });
  if (has("sums-roundings")) {
    double sum = 0.0, before = 0.0;
    for (double& x : s.plus) {
      sum += std::round((x - before) / 2e-6) * 2e-6;
      before = x;
      x = sum;
    }
  }
  if (has("minus-turned")) minus([](double x) { return -x; });
  if (has("minus-from-elsewhere")) minus([](double x) { return x + 20e-6; });
  if (has("columns-exchanged")) std::swap(s.plus, s.minus);
  if (has("minus-backwards")) std::reverse(s.minus.begin(), s.minus.end());
  if (has("rotary-in-radians") && s.job.rotary) both([](double x) { return x / deg_per_rad; });
  return controllers::list_file(s, "spoiled", s.columns());
}

/// What the kit would not let through: points are changed once it has written and read them.
void spoil_lines(Artifact& file, bool rotary) {
  std::string out;
  std::size_t points = 0, n = 0;
  for (const std::string_view line : controllers::lines_of(file.bytes))
    points += !line.empty() && line.front() != '#' ? 1U : 0U;
  for (const std::string_view line : controllers::lines_of(file.bytes)) {
    auto words = controllers::words_of(line);
    if (line.empty() || line.front() == '#' || words.size() < 3) {
      out += std::string(line) + "\n";
      continue;
    }
    ++n;
    std::vector<std::string> texts(words.begin(), words.end());
    const auto times = [&](std::size_t column, double by, double more = 0.0) {
      if (column < texts.size())
        texts[column] = std::to_string(by * controllers::real(texts[column]).value_or(0.0) + more);
    };
    if (has("minus-x10")) times(3, 10.0);
    if (has("minus-in-um")) times(3, 1000.0);
    if (has("minus-of-a-constant")) times(3, 0.0, 0.001);
    if (has("plus-x10")) times(2, 10.0);
    if (has("one-point-off") && n == points / 2) times(2, 1.0, 0.015);
    if (has("turn-that-does-not-close") && rotary && n == points)
      times(2, 1.0, 0.005), times(3, 1.0, 0.005);
    for (std::size_t i = 0; i < texts.size(); ++i) out += (i > 0 ? " " : "") + texts[i];
    out += "\n";
  }
  file.bytes = std::move(out);
}

[[maybe_unused]] Expected<OutputResult> write_table(const ControllerInput& in) {
  if (has("refuses-all")) return fail("expected something else");
  if (has("throws")) throw std::runtime_error("wrong on purpose");
  if (has("writes-nothing")) return OutputResult{};
  ControlTable t = declared();
  if (has("writes-as-error")) t.sign = ControlTable::Sign::error;
  auto r = controllers::write_tables(
      in, {.name = "spoiled", .table = t, .keys = {}, .files = files, .parse = parse});
  if (r)
    for (Artifact& a : r->artifacts) spoil_lines(a, a.name.find("-C") != a.name.npos);
  if (r && !r->artifacts.empty() && (spoiled::impurity() + spoiled::counted()) != 0.0)
    r->artifacts.front().bytes +=
        "# " + std::to_string(spoiled::impurity() + spoiled::counted()) + "\n";
  return r;
}

}  // namespace

NONIO_PLUGIN(registry) {
  spoiled::at_registration();
  if (has("registers-nothing")) return;
#ifdef SPOILED_TABLE
  Controller o = controllers::controller(spoiled::info("spoiled"), declared(), write_table, parse);
  if (has("without-parse")) o.parse = nullptr;
#else
  Output o;
  o.info = spoiled::info("spoiled");
  o.applies = [](const Campaign&) { return true; };
  o.write = write_text;
  if (has("path-by-choice") || has("crashes-by-choice"))
    o.info.options.push_back({"kind", std::string("a"), "", "A kind.", {"a", "b"}});
  if (has("crashes-at-the-end"))
    o.info.options.push_back({"size", 1.0, "", "A size.", {}, 0.0, 10.0});
  if (has("without-write")) o.write = nullptr;
#endif
  registry.add(o);
}
