// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/host/campaign_reader.h"
#include "nonio/model/explain.h"

/// The model of one campaign against its measurements: what the verbs and the nightly run share.
namespace nonio::host {

/// The measurements of one axis with the effects that the model and the catalogue have for it. The
/// terms point into the campaign's effects.
struct PartModel {
  model::Part part;
  std::vector<model::Term> terms, catalogue;
  std::string unfit;  ///< why these readings cannot show the model; "" if they can

  const Axis& axis() const { return part.axes.front(); }
  Quantity deviation() const { return deviation_of(axis().rotary); }
  std::vector<std::string> names() const;
};

/// A reading of a part, as a person finds it again.
struct ReadingPlace {
  std::string measurement, file;
  std::uint64_t line = 0;  ///< 0: the reader does not say
  std::uint32_t run = 0;   ///< 0: the same
  int direction = 0;
  double target = 0.0;  ///< m or rad
};
ReadingPlace place_of(const PartModel& part, const Campaign& campaign, std::size_t row);

/// What is wrong with a list of effects: form, unknown kind or axis (with the nearest name), twice
/// the same.
std::vector<std::string> model_mistakes(const std::vector<std::string>& effects,
                                        const ReadCampaign& read);

/// One entry for each axis with readings. `effects` is the model, usually that of the manifest. The
/// error is a mistake in it, with the line of [model] effects.
Expected<std::vector<PartModel>> part_models(const ReadCampaign& read,
                                             const std::vector<std::string>& effects);

/// Effects of the model on axes that were not measured here.
std::vector<std::string> unmeasured(const std::vector<std::string>& effects,
                                    const std::vector<PartModel>& parts);

/// Effects of a fit whose values are all below their uncertainty (|value| < 2 u).
std::vector<std::string> below_uncertainty(const model::Fit& fit);

Expected<model::Comparison> compare_part(const PartModel& part);
Expected<model::Explanation> explain_part(const PartModel& part, std::uint64_t seed);

}  // namespace nonio::host
