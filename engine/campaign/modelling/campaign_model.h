// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/reading/campaign_reader.h"
#include "nonio/model/explain.h"

/// The model of one campaign against its measurements: what the verbs and the nightly run share.
namespace nonio::modelling {

/// Rows of a part as words name them: the file of the first, and the lines of at most eight.
struct RowsPlace {
  std::size_t count = 0;
  std::string file, lines;
};
/// Measurements that are explained together, with the effects that the model and the catalogue have
/// for it. The terms point into the campaign's effects.
struct PartModel {
  model::Part part;
  std::vector<model::Term> terms, catalogue;
  std::string unfit;  ///< why these readings cannot show the model; "" if they can
  std::vector<model::Candidate> left_out{};  ///< effects that do not apply, and why
  RowsPlace interpolated{};                  ///< readings whose temperature is interpolated
  /// The library, of an axis: its causes are searched where the catalogue may not explain.
  config::Library library{};
  /// Effects whose value is stated. Their prediction is subtracted from the deviations of `part`,
  /// so that everything else is fitted to the rest; a comparison has them after its other terms.
  struct Held {
    model::Term term;
    model::Parameter parameter;
    std::string text;          ///< as the model has it: "squareness:XY = 12.3 arcsec"
    std::vector<double> part;  ///< of each reading, m or rad
  };
  std::vector<Held> held{};

  /// Deviations as they were read.
  std::vector<double> measured() const;
  Quantity deviation() const { return deviation_of(part.table.angular); }
  /// Of the coordinate along the line of a reading: a position, an angle or a time.
  Quantity position() const {
    if (part.kind == model::Part::Kind::course) return Quantity::time;
    return position_of(part.kind != model::Part::Kind::space && part.axes.front().rotary);
  }
  /// Of the model as it is written: without what is always there.
  std::vector<std::string> names() const;
  /// Whether the effect is of something that is measured here.
  bool shows(const std::string& written) const;
};

/// What a part is called in words: "axis", "space", "balls", "course" (templates/words, term.part).
std::string kind_of(const model::Part& part);

/// A reading of a part, as a person finds it again.
struct ReadingPlace {
  std::string measurement, file;
  std::uint64_t line = 0;  ///< 0: the reader does not state it
  std::uint32_t run = 0;   ///< 0: the same
  int direction = 0;       ///< 0: the reader does not state it
  double target = 0.0;     ///< along its line, m or rad
  Quantity position = Quantity::length;
};
ReadingPlace place_of(const PartModel& part, const Campaign& campaign, std::size_t row);

RowsPlace place_of(const PartModel& part, const Campaign& campaign,
                   const std::vector<std::uint32_t>& rows);

/// What is wrong with a list of effects: form, unknown kind or axis (with the nearest name), twice
/// the same.
std::vector<std::string> model_mistakes(const std::vector<std::string>& effects,
                                        const reading::ReadCampaign& read);

/// One entry for each part of the campaign (model/explain.h). `effects` is the model, usually that
/// of the manifest. The error is a mistake in it, with the line of [model] effects.
Expected<std::vector<PartModel>> part_models(const reading::ReadCampaign& read,
                                             const std::vector<std::string>& effects);

/// Why a campaign has no part: what is measured in it, and what effects explain.
Error nothing_to_compare(const reading::ReadCampaign& read);
/// Kinds of the measurements that have readings, each once, as in the manifest.
std::vector<std::string> kinds_measured(const reading::ReadCampaign& read);

/// What `part_models` is made of: readings without a model and a catalogue, and the catalogue, for
/// which every effect looks at every reading.
std::vector<PartModel> bare_parts(const reading::ReadCampaign& read);
void fill_catalogue(PartModel& part, const reading::ReadCampaign& read);
void fill_interpolated(PartModel& part, const reading::ReadCampaign& read);
/// The first mistake as an error, with the line of [model] effects.
Expected<void> without_mistakes(const std::vector<std::string>& effects,
                                const reading::ReadCampaign& read);
/// Another model for the same readings. `effects` has no mistakes.
void set_model(PartModel& part, const std::vector<std::string>& effects,
               const reading::ReadCampaign& read);

/// Effects of the model that no measurement here can show.
std::vector<std::string> unmeasured(const std::vector<std::string>& effects,
                                    const std::vector<PartModel>& parts);

/// Effects of a fit whose values are all below their uncertainty (|value| < 2 u).
std::vector<std::string> below_uncertainty(const model::Fit& fit);

/// `known` and `fitted` as in model/explain.h.
Expected<model::Comparison> compare_part(const PartModel& part,
                                         const model::Groundwork* known = nullptr,
                                         const model::Fitted& fitted = {});
/// Terms of the causes of the library that these readings can show; `keeps` has their effects.
std::vector<model::Term> library_of(const PartModel& part, std::shared_ptr<const void>& keeps);
/// `with_library`: with the second stage of the search, in which causes of the library take part.
Expected<model::Explanation> explain_part(const PartModel& part, std::uint64_t seed,
                                          const model::Groundwork* known = nullptr,
                                          bool with_library = true);

}  // namespace nonio::modelling
