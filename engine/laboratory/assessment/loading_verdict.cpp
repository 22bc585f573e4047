// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/loading_verdict.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "campaign/evaluation/control_tables.h"
#include "campaign/tables/table_check.h"
#include "laboratory/assessment/table_changes.h"
#include "platform/process/guarded.h"

namespace nonio::assessment {

namespace {

Expected<std::size_t> only_measurement(const reading::ReadCampaign& read, const std::string& axis) {
  const Campaign& campaign = read.manifest->campaign;
  std::optional<std::size_t> found;
  std::size_t count = 0;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.kind != "axis" || control_axis(campaign.machine, m) != axis ||
        read.observations[i].size() == 0)
      continue;
    found = i, ++count;
  }
  if (count == 1) return *found;
  return fail("campaign " + campaign.id + " has " + std::to_string(count) +
              " measurements of axis " + axis + " with readings; expected one");
}

statistics::TableCurve curve_of(const evaluation::AxisCorrection& c, bool rotary) {
  const double at = unit_of(position_of(rotary)).per_si, of = unit_of(deviation_of(rotary)).per_si;
  statistics::TableCurve out{c.position, c.plus, c.minus};
  for (double& x : out.position) x *= at;
  for (auto* values : {&out.plus, &out.minus})
    for (double& v : *values) v *= of;
  if (rotary) out.repeat_after(360.0);
  return out;
}

statistics::MeasuredCurve measured_curve(const evaluation::ControlTables& t) {
  const auto c = curve_of({t.position, t.plus, t.minus, {}}, t.rotary);
  return {c.position, c.plus, c.minus, t.u * unit_of(deviation_of(t.rotary)).per_si};
}

Campaign pair_of(const Campaign& before, std::size_t one, const Campaign& after, std::size_t two) {
  Campaign pair = before;
  pair.measurements = {before.measurements[one], after.measurements[two]};
  pair.measurements[0].id = before.id, pair.measurements[1].id = after.id;
  pair.measurements[0].adjustment = "before", pair.measurements[1].adjustment = "after";
  return pair;
}

const Analysis* comparing(const loader::Plugins& plugins, const Campaign& pair) {
  Campaign alone = pair;
  alone.measurements.erase(alone.measurements.begin());
  for (const Analysis& a : plugins.analyses())
    if (a.applies != nullptr && a.applies(pair, pair.measurements[1]) &&
        !a.applies(alone, alone.measurements[0]))
      return &a;
  return nullptr;
}

Expected<std::vector<Finding>> compared(const reading::ReadCampaign& before, std::size_t one,
                                        const reading::ReadCampaign& after, std::size_t two,
                                        const ControlTable& control,
                                        const loader::Plugins& plugins) {
  const Campaign pair = pair_of(before.manifest->campaign, one, after.manifest->campaign, two);
  const Analysis* const analysis = comparing(plugins, pair);
  if (analysis == nullptr)
    return fail("campaign " + after.manifest->campaign.id +
                " did not measure the line of campaign " + before.manifest->campaign.id +
                " (at, side and axis must be equal), or the analysis that compares both is not "
                "loaded");
  const std::vector<Observations> readings{before.observations[one], after.observations[two]};
  auto options = config::options_from(analysis->info, {});
  if (!options) return fail(options.error().front());
  auto evaluation = process::guarded("analysis " + analysis->info.name, [&] {
    return analysis->analyse(
        {pair, pair.measurements[1], readings[1], *options, &readings, &control});
  });
  if (!evaluation) return fail(evaluation.error());
  std::erase_if(evaluation->findings,
                [](const Finding& f) { return !f.id.starts_with("before-after."); });
  return std::move(evaluation->findings);
}

std::optional<statistics::TableChange> change_between(const reading::ReadCampaign& before,
                                                      const reading::ReadCampaign& after,
                                                      const std::string& axis,
                                                      const std::vector<LoadedTable>& next,
                                                      const evaluation::WantedController& control) {
  const auto of = [&](const reading::ReadCampaign& read) {
    std::vector<Remark> notes;
    auto all = evaluation::control_tables(read, {}, {control}, notes);
    std::erase_if(all, [&](const evaluation::ControlTables& t) { return t.axis != axis; });
    return all;
  };
  const auto one = of(before), two = of(after);
  if (one.size() != 1 || two.size() != 1 || !one.front().active) return std::nullopt;
  const bool rotary = one.front().rotary;
  return statistics::recognize(measured_curve(one.front()), measured_curve(two.front()),
                               curve_of(*one.front().active, rotary),
                               {curve_of(evaluation::correction_of(next, axis), rotary)},
                               usual_scale_change(rotary), change_resolution);
}

LoadingVerdict::Answer answer_of(const std::vector<Finding>& findings) {
  using Answer = LoadingVerdict::Answer;
  const auto has = [&](std::initializer_list<std::string_view> ids) {
    return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) {
      return std::find(ids.begin(), ids.end(), f.id) != ids.end();
    });
  };
  if (has({"before-after.not-active", "before-after.wrong-sign", "before-after.something-else",
           "before-after.reversal-not-active", "before-after.reversal-wrong-sign",
           "before-after.reversal-something-else"}))
    return Answer::failed;
  return has({"before-after.worked"}) ? Answer::worked : Answer::not_decided;
}

}  // namespace

Expected<LoadingVerdict> judge_loading(const reading::ReadCampaign& before,
                                       const reading::ReadCampaign& after, const std::string& axis,
                                       const std::vector<LoadedTable>& next,
                                       const evaluation::WantedController& control,
                                       const loader::Plugins& plugins) {
  NONIO_TRY(const auto one, only_measurement(before, axis));
  NONIO_TRY(const auto two, only_measurement(after, axis));
  LoadingVerdict out;
  NONIO_TRY(out.findings, compared(before, one, after, two, control.controller->table, plugins));
  out.answer = answer_of(out.findings);
  if (out.answer != LoadingVerdict::Answer::worked)
    out.change = change_between(before, after, axis, next, control);
  // Advice about the reversal holds only with the right table, and the change states which one is on.
  if (out.change && out.change->loading != statistics::Loading::loaded)
    std::erase_if(out.findings, [](const Finding& f) {
      return f.id.ends_with("not-active") || f.id.ends_with("wrong-sign") ||
             f.id.ends_with("something-else");
    });
  const Measurement& m = after.manifest->campaign.measurements[two];
  out.E = tables::forecast_of_axis(after.manifest->campaign, m, axis, after.observations[two],
                                   after.observations[two], {}, {})
              .E[0];
  return out;
}

}  // namespace nonio::assessment
