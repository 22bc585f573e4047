// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_prediction.h"

#include "platform/storage/nearest.h"

namespace nonio::modelling {

namespace {

/// Matches kind and name, or the displacement over time. Returns null for ball centers.
const PartModel* same_part(const std::vector<PartModel>& parts, const PartModel& wanted) {
  const PartModel* found = nullptr;
  for (const PartModel& part : parts) {
    if (part.part.kind != wanted.part.kind || part.part.kind == model::Part::Kind::balls) continue;
    if (part.part.name == wanted.part.name) return &part;
    if (part.part.kind == model::Part::Kind::course &&
        part.part.displacement == wanted.part.displacement && found == nullptr)
      found = &part;
  }
  return found;
}

std::string listed_parts(const std::vector<PartModel>& parts) {
  std::vector<std::string> names;
  for (const PartModel& part : parts) names.push_back(part.part.name);
  return names.empty() ? "none" : storage::listed(names);
}

std::size_t named_terms(const PartModel& part) { return part.names().size(); }

}  // namespace

Expected<std::vector<Predicted>> predictions(const reading::ReadCampaign& seen,
                                             const reading::ReadCampaign& unseen, bool zero_kept) {
  NONIO_TRY(auto known, part_models(seen, seen.manifest->campaign.model));
  std::vector<PartModel> others = bare_parts(unseen);
  std::vector<Predicted> out;
  for (PartModel& other : others) {
    const PartModel* part = same_part(known, other);
    if (part == nullptr) continue;
    const bool course = other.part.kind == model::Part::Kind::course;
    if (!course) {
      if (zero_kept)
        return fail(other.part.name + ": expected --zero free; its lines have zeros of their own");
      set_model(other, {}, unseen);
    }
    auto predicted = course
                         ? model::predict(part->part, part->terms, other.part, zero_kept)
                         : model::predict_places(part->part, part->terms, other.part, other.terms);
    if (!predicted) {
      std::string why = predicted.error().message;
      for (const model::ChannelLeft& left : other.part.channels_left)
        if (left.fails()) why += "; the thermometer " + left.name + " fails there";
      return fail(other.part.name + ": " + why);
    }
    out.push_back({*part, std::move(other), std::move(*predicted)});
  }
  if (out.empty())
    return fail("nothing that a model explains is in both campaigns: " +
                seen.manifest->campaign.id + " has " + listed_parts(known) + ", " +
                unseen.manifest->campaign.id + " has " + listed_parts(others));
  return out;
}

storage::Json predict_json(const std::vector<Predicted>& all, const Campaign& seen,
                           const Campaign& unseen, const ModelWords& words, bool zero_kept) {
  storage::Json json = {{"schema", "nonio-predict/1"},
                        {"campaign", unseen.id},
                        {"model_of", seen.id},
                        {"zero", zero_kept ? "kept" : "free"}};
  storage::Json parts = storage::Json::array();
  for (const Predicted& one : all) {
    const model::Prediction& p = one.prediction;
    const Quantity q = one.unseen.deviation();
    storage::Json part = {{"part", one.unseen.part.name},
                          {"observations", one.unseen.part.table.size()},
                          {"effects", one.seen.names()},
                          {"terms", named_terms(one.seen)}};
    storage::put(part, "rms", p.rms, q);
    storage::put(part, "sd", p.sd, q);
    storage::put(part, "inside_U", p.inside, Quantity::ratio);
    double u = 0.0;
    for (const double one_u : p.u) u += one_u / static_cast<double>(p.u.size());
    storage::put(part, "U", 2.0 * u, q);
    if (p.fails_from)
      storage::put(part, "holds_until", *p.fails_from, Quantity::time);
    else if (one.unseen.part.kind == model::Part::Kind::course)
      part["holds_until_s"] = nullptr;
    if (p.fails_until) storage::put(part, "holds_from", *p.fails_until, Quantity::time);
    part["outside_range"] = p.outside;
    if (p.left_out > 0) part["left_out"] = p.left_out;
    std::string says = words.prediction(p, one.unseen);
    for (const std::string& said : words.recordings(one.unseen, {})) says += " " + said;
    part["says"] = std::move(says);
    parts.push_back(std::move(part));
  }
  json["parts"] = std::move(parts);
  return json;
}

}  // namespace nonio::modelling
