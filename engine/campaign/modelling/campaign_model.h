// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/reading/campaign_reader.h"
#include "nonio/model/explain.h"

/// The model of one campaign compared with its measurements, as the commands and the nightly run
/// use it.
namespace nonio::modelling {

/// Rows of a part for a message: the file of the first row, and at most eight line numbers.
struct RowsPlace {
  std::size_t count = 0;
  std::string file, lines;
};
/// Measurements that are explained together, with the effects that the model and the catalogue
/// contain for them. The terms point to effects of the campaign.
struct PartModel {
  model::Part part;
  std::vector<model::Term> terms, catalogue;
  std::string unfit;  ///< why these readings cannot show the model; "" if they can
  std::vector<model::Candidate> left_out{};  ///< effects that do not apply, with the reason
  RowsPlace interpolated{};                  ///< readings whose temperature is interpolated
  /// The causes of the library, null if the part is not an axis. They are searched if the catalogue
  /// may not explain the readings.
  config::Library library{};
  /// Effects whose value the model states. Their prediction is subtracted from the deviations of
  /// `part`, and all other effects are fitted to what remains. A comparison lists them after its
  /// other terms.
  struct Held {
    model::Term term;
    model::Parameter parameter;
    std::string text;          ///< entry of the model: "squareness:XY = 12.3 arcsec"
    std::vector<double> part;  ///< prediction of the effect for each reading, m or rad
  };
  std::vector<Held> held{};

  /// Returns the deviations as they were read, including the effects whose value is stated.
  std::vector<double> measured() const;
  Quantity deviation() const { return deviation_of(part.table.angular); }
  /// Returns the quantity of the coordinate along the line of a reading: a position, an angle or a
  /// time.
  Quantity position() const {
    if (part.kind == model::Part::Kind::course) return Quantity::time;
    return position_of(part.kind != model::Part::Kind::space && part.axes.front().rotary);
  }
  /// Returns the effects of the model as a manifest lists them, without those that every model
  /// contains.
  std::vector<std::string> names() const;
  /// Whether the measurements of this part can show an effect.
  bool shows(const std::string& written) const;
};

/// Returns the id of the kind of a part: "axis", "space", "balls", "course" (templates/words,
/// term.part).
std::string kind_of(const model::Part& part);

/// The place of a reading, by which a person finds it.
struct ReadingPlace {
  std::string measurement, file;
  std::uint64_t line = 0;  ///< line in the file; 0: the reader does not state it
  std::uint32_t run = 0;   ///< number of the run; 0: the reader does not state it
  int direction = 0;       ///< direction of motion, +1 or -1; 0: the reader does not state it
  double target = 0.0;     ///< coordinate along the line: m, rad or s, as `position` states
  Quantity position = Quantity::length;
};
ReadingPlace place_of(const PartModel& part, const Campaign& campaign, std::size_t row);

RowsPlace place_of(const PartModel& part, const Campaign& campaign,
                   const std::vector<std::uint32_t>& rows);

/// Returns what is wrong in a list of effects: wrong form, unknown kind or axis (with the nearest
/// name), an effect of the set-up, which every model contains, a value that cannot be stated, or an
/// effect that occurs twice.
std::vector<std::string> model_mistakes(const std::vector<std::string>& effects,
                                        const reading::ReadCampaign& read);

/// Returns one entry for each part of the campaign (model/explain.h) with the model `effects`,
/// which is usually that of the manifest. A mistake in the model is an error with the line of
/// [model] effects.
Expected<std::vector<PartModel>> part_models(const reading::ReadCampaign& read,
                                             const std::vector<std::string>& effects);

/// Returns the error about a campaign without parts: what was measured, and what effects can
/// explain.
Error nothing_to_compare(const reading::ReadCampaign& read);
/// Returns the kinds of the measurements that have readings, each once, in the order of the
/// manifest.
std::vector<std::string> kinds_measured(const reading::ReadCampaign& read);

/// The steps of `part_models`. `bare_parts` returns the parts with their readings only,
/// `fill_catalogue` adds the catalogue, for which every effect examines every reading, and the
/// places of interpolated temperatures. `fill_interpolated` adds only these places.
std::vector<PartModel> bare_parts(const reading::ReadCampaign& read);
void fill_catalogue(PartModel& part, const reading::ReadCampaign& read);
void fill_interpolated(PartModel& part, const reading::ReadCampaign& read);
/// Returns the first mistake as an error, with the line of [model] effects.
Expected<void> without_mistakes(const std::vector<std::string>& effects,
                                const reading::ReadCampaign& read);
/// Sets another model for the same readings. `effects` must be free of mistakes. If the readings
/// cannot show the model, `unfit` states why.
void set_model(PartModel& part, const std::vector<std::string>& effects,
               const reading::ReadCampaign& read);

/// Returns the effects of the model that no measurement of the campaign can show.
std::vector<std::string> unmeasured(const std::vector<std::string>& effects,
                                    const std::vector<PartModel>& parts);

/// Returns the effects of a fit, except those of the set-up, whose linear parameters are all
/// smaller in magnitude than 2 u.
std::vector<std::string> below_uncertainty(const model::Fit& fit);

/// Compares a part with its model. `known` and `fitted`: see model/explain.h.
Expected<model::Comparison> compare_part(const PartModel& part,
                                         const model::Groundwork* known = nullptr,
                                         const model::Fitted& fitted = {});
/// Returns the terms for causes of the library that these readings can show. `keeps` receives the
/// owner of their effects.
std::vector<model::Term> library_of(const PartModel& part, std::shared_ptr<const void>& keeps);
/// Searches for effects that explain what the model of a part leaves in its residuals, and states a
/// verdict. If `with_library`, a second stage of the search includes causes of the library.
/// `known`: see model/explain.h.
Expected<model::Explanation> explain_part(const PartModel& part, std::uint64_t seed,
                                          const model::Groundwork* known = nullptr,
                                          bool with_library = true);

}  // namespace nonio::modelling
