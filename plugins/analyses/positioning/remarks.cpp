// SPDX-License-Identifier: Apache-2.0
#include "remarks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

namespace nonio::positioning {

using math::Confidence;
using math::PositioningRule;
using math::RuleForm;

namespace {

template <class Wanted>
Rules those(const Rules& rules, const Wanted& wanted) {
  Rules out;
  std::copy_if(rules.begin(), rules.end(), std::back_inserter(out),
               [&](const PositioningRule* r) { return wanted(*r); });
  return out;
}

Rules of_form(const Rules& rules, RuleForm form) {
  return those(rules, [&](const PositioningRule& r) { return r.form == form; });
}

std::string titles(const Rules& rules) {
  std::string out;
  for (const PositioningRule* r : rules) out += (out.empty() ? "" : ", ") + std::string(r->title);
  return out;
}

class Remarks {
 public:
  /// Nothing if there is no such rule.
  void say(const char* id, const Rules& of, std::vector<Number> evidence = {}) {
    if (!of.empty()) out_.push_back({id, std::move(evidence), {{"rules", titles(of)}}, {}, {}});
  }
  void say_if(bool so, const char* id) {
    if (so) out_.push_back({id, {}, {}, {}, {}});
  }
  std::vector<Remark> take() { return std::move(out_); }

 private:
  std::vector<Remark> out_;
};

/// The names of the rules in the values, with their titles: "iso-1988" is "ISO 230-2:1988".
Remark evaluated(const Rules& rules) {
  Remark out{"rules.evaluated", {}, {{"rules", titles(rules)}}, {}, {}};
  for (const PositioningRule* r : rules) out.texts.emplace_back(r->name, r->title);
  return out;
}

}  // namespace

std::vector<Remark> remarks_on(const Rules& rules, const TakenOff& off, bool with_U) {
  Remarks remarks;
  for (const double k : {2.0, 3.0})
    remarks.say(
        "rules.k",
        those(rules, [&](const PositioningRule& r) { return r.form == RuleForm::iso && r.k == k; }),
        {{"k", k, Quantity::count}, {"two_k", 2.0 * k, Quantity::count}});
  remarks.say("rules.upr", of_form(rules, RuleForm::upr));
  remarks.say("rules.vdi", of_form(rules, RuleForm::vdi));
  remarks.say("rules.raw", of_form(rules, RuleForm::raw));
  remarks.say("rules.nmtba", of_form(rules, RuleForm::nmtba));
  remarks.say("rules.jis", of_form(rules, RuleForm::jis));
  std::vector<Remark> out = {evaluated(rules)};
  for (Remark& r : remarks.take()) out.push_back(std::move(r));

  const Rules without = those(rules, [](const PositioningRule& r) { return r.without_offset; });
  if (!without.empty() && std::isfinite(off.value))
    out.push_back({"rules.offset",
                   {{"offset", off.value, off.quantity}},
                   {{"rules", titles(without)}, {"how", off.option}},
                   {},
                   {}});

  const auto with_k = [&](double k) {
    return std::any_of(rules.begin(), rules.end(), [&](const PositioningRule* r) {
      return r->form == RuleForm::iso && r->k == k;
    });
  };
  const bool iso = with_k(2.0) || with_k(3.0), vdi = !of_form(rules, RuleForm::vdi).empty(),
             raw = !of_form(rules, RuleForm::raw).empty(),
             nmtba = !of_form(rules, RuleForm::nmtba).empty(),
             jis = !of_form(rules, RuleForm::jis).empty();
  remarks.say_if(with_k(2.0) && with_k(3.0), "rules.differ-k");
  remarks.say_if(vdi && iso, "rules.differ-vdi");
  remarks.say_if(raw && (iso || vdi || nmtba), "rules.differ-raw");
  remarks.say_if((nmtba || jis) && (iso || vdi || raw), "rules.differ-plus-minus");
  remarks.say_if(jis && (iso || vdi || nmtba || raw), "rules.differ-one-pass");
  remarks.say("rules.known", those(rules, [](const PositioningRule& r) {
                return r.confidence == Confidence::known;
              }));
  remarks.say("rules.inferred", those(rules, [](const PositioningRule& r) {
                return r.confidence == Confidence::inferred;
              }));
  remarks.say_if(vdi, "rules.value-inferred");
  remarks.say_if(with_U, "rules.uncertainty");
  for (Remark& r : remarks.take()) out.push_back(std::move(r));
  return out;
}

}  // namespace nonio::positioning
