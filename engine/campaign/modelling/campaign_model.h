// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/config/fleet.h"
#include "campaign/reading/campaign_reader.h"
#include "nonio/model/explain.h"

namespace nonio::modelling {

/// Rows of a part: the file of the first row, and at most eight line numbers.
struct RowsPlace {
  std::size_t count = 0;
  std::string file, lines;
};
/// Measurements that are explained together. Terms refer to effects of the campaign.
struct PartModel {
  model::Part part;
  std::vector<model::Term> terms, catalogue;
  std::string unfit;  ///< why these readings cannot show the model; "" if they can
  std::vector<model::Candidate> left_out{};
  RowsPlace interpolated{};  ///< readings whose temperature is interpolated
  /// Causes of the library; null if the part is not an axis.
  config::Library library{};
  config::Priors priors{};  ///< counts that the search uses (`use_priors`)
  /// Effects with a stated value. Their prediction is subtracted from the deviations of `part`.
  struct Held {
    model::Term term;
    model::Parameter parameter;
    std::string text;          ///< entry of the model: "squareness:XY = 12.3 arcsec"
    std::vector<double> part;  ///< prediction of the effect for each reading, m or rad
  };
  std::vector<Held> held{};

  std::vector<double> measured() const;
  Quantity deviation() const { return deviation_of(part.table.angular); }
  /// Coordinate along the line: a position, an angle or a time.
  Quantity position() const {
    if (part.kind == model::Part::Kind::course) return Quantity::time;
    return position_of(part.kind != model::Part::Kind::space && part.axes.front().rotary);
  }
  /// Returns the effects as a manifest lists them, without those that every model contains.
  std::vector<std::string> names() const;
  bool shows(const std::string& written) const;
};

/// Returns "axis", "space", "balls" or "course" (templates/words, term.part).
std::string kind_of(const model::Part& part);

struct ReadingPlace {
  std::string measurement, file;
  std::uint64_t line = 0;  ///< line in the file; 0 if not stated
  std::uint32_t run = 0;   ///< number of the run; 0 if not stated
  int direction = 0;       ///< direction of motion, +1 or -1; 0 if not stated
  double target = 0.0;     ///< coordinate along the line: m, rad or s
  Quantity position = Quantity::length;
};
ReadingPlace place_of(const PartModel& part, const Campaign& campaign, std::size_t row);

RowsPlace place_of(const PartModel& part, const Campaign& campaign,
                   const std::vector<std::uint32_t>& rows);

/// Returns the mistakes in a list of effects: wrong forms, unknown kinds or axes, effects of the
/// set-up, stated values that are not possible, and repetitions.
std::vector<std::string> model_mistakes(const std::vector<std::string>& effects,
                                        const reading::ReadCampaign& read);

/// Returns one entry for each part of the campaign (model/explain.h). A mistake in the model is an
/// error with the line of [model] effects.
Expected<std::vector<PartModel>> part_models(const reading::ReadCampaign& read,
                                             const std::vector<std::string>& effects);

Error nothing_to_compare(const reading::ReadCampaign& read);
/// Kinds of measurements with readings, each once, in the order of the manifest.
std::vector<std::string> kinds_measured(const reading::ReadCampaign& read);

/// Steps of `part_models`: readings alone, the catalog, and the places of interpolated temperatures
/// (included in `fill_catalogue`).
std::vector<PartModel> bare_parts(const reading::ReadCampaign& read);
void fill_catalogue(PartModel& part, const reading::ReadCampaign& read);
void fill_interpolated(PartModel& part, const reading::ReadCampaign& read);
Expected<void> without_mistakes(const std::vector<std::string>& effects,
                                const reading::ReadCampaign& read);
/// `effects` must be free of mistakes. `part.unfit`: why the readings cannot show this model.
void set_model(PartModel& part, const std::vector<std::string>& effects,
               const reading::ReadCampaign& read);

/// Sets the frequencies of the candidates. Results of a run do not use them, so that a count does
/// not depend on an earlier count, nor a document on the machines of others.
void use_priors(PartModel& part, config::Priors priors);

/// Returns the effects of the model that no measurement of the campaign can show.
std::vector<std::string> unmeasured(const std::vector<std::string>& effects,
                                    const std::vector<PartModel>& parts);

/// Compares a part with its model. `known` and `fitted`: see model/explain.h.
Expected<model::Comparison> compare_part(const PartModel& part,
                                         const model::Groundwork* known = nullptr,
                                         const model::Fitted& fitted = {});
/// `keeps` receives the owner of the effects.
std::vector<model::Term> library_of(const PartModel& part, std::shared_ptr<const void>& keeps);
/// Searches for effects that explain the residuals. `with_library` adds a search of causes.
/// `known`: see model/explain.h.
Expected<model::Explanation> explain_part(const PartModel& part, std::uint64_t seed,
                                          const model::Groundwork* known = nullptr,
                                          bool with_library = true);

}  // namespace nonio::modelling
