// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "look.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/plugin.h"

/// Tables and figures of a measurement, for all documents about a campaign. They are compiled into
/// each plugin. Blocks are in one language.
namespace nonio::pages {

struct Source {
  const OutputInput& in;
  const Look& look;
  const reports::Wording& words;
  const reports::Fonts& fonts;
  /// Whether it is a certificate, which contains only results with an uncertainty, and no
  /// explanations.
  bool certificate = false;

  const std::string& language() const { return words.language(); }
};

using Blocks = std::vector<reports::Block>;

/// A measurement with its analyses and findings.
struct Measured {
  const Measurement& measurement;
  const Observations& observations;
  bool rotary = false;
  std::vector<const Results::Analysed*> analyses;
  std::vector<const Finding*> findings;  ///< each id once, warnings first
};
std::vector<Measured> measured(const OutputInput&);

/// Converts to the symbol of the standard: "A+" becomes "A↑".
std::string symbol(std::string_view name);

/// "A" for the value "iso-1988:A" of a rule.
std::string without_rule(const std::string& name);
/// Explanation of a result in the language of the document, such as that of "distance_C" with the
/// axis C. Empty if there is no text.
std::string meaning_of(const Source& source, const std::string& name);

/// Formats a stated number, tolerance or uncertainty as short as possible: "20", not "20.00".
std::string plain_number(const Source&, double si, Quantity);

/// U of the instrument's certificate: "0.1 µm + 0.5 µm/m · L".
std::string instrument_U(const Source&);

/// Removes separators of empty parts of a line: "worn-screw · " becomes "worn-screw".
std::string without_gaps(std::string line);

/// Whether the readings are runs over one position: of an axis, or along a diagonal.
inline bool over_one_position(const Measurement& m) {
  return m.kind == "axis" || m.kind == "straightness" || m.kind == "angle" || m.kind == "diagonal";
}

std::string heading_of(const Source&, const Measured&);
std::string test_of(const Source&, const Measured&);
/// Positions of the readings; for a diagonal the distance from its start.
std::vector<double> along_line(const Measured&);
/// Title without the name of a standard whose test plan was not followed.
std::string analysis_title(const Source&, const Results::Analysed&);
/// Whether the test followed the plan of the standard. For an axis that the standard requires to be
/// measured in two tests (the whole travel, and a part of it more often), the other test may be
/// another measurement.
bool follows_plan(const OutputInput&, const Results::Analysed&);
const Conformity* conformity_of(const OutputInput&, const Results::Analysed&,
                                const std::string& name);
std::string decision_text(const Source&, Decision);
/// One sentence for each limit of the manifest without a result: axes that were not measured,
/// results that a test does not give.
std::vector<std::string> undecided(const Source&);
/// The decision rule of the campaign with its risk.
std::string rule_text(const Source&);

void add_results(const Source&, const Measured&, Blocks&);
void add_targets(const Source&, const Measured&, Blocks&);
void add_plots(const Source&, const Measured&, Blocks&);
/// The main figure of a measurement: its readings by run, its circle or its volume.
std::optional<reports::Plot> readings_plot(const Source&, const Measured&);
/// Heading of expanded uncertainties with one coverage factor: "U (k = 2)".
std::string U_heading(const Source&, double k);
/// Results for which the laboratory's smallest uncertainty (CMC) replaces that of the budget; empty
/// if there are none.
std::string cmc_text(const Source&, const Results::Analysed&);
void add_budget(const Source&, const Measured&, Blocks&);

/// Checks the texts of manifest and site before they become parts of sentences. The error names the
/// key, so that the host can add its line.
Expected<void> check_texts(const Campaign&, const reports::Fonts&);

/// Errors in templates/<name>*.toml, and in words/<language>/<name>.toml of every language compared
/// with English: keys, placeholders, characters that the fonts do not contain.
std::vector<Error> check_templates(const Templates&, const std::string& name,
                                   Expected<Look> (*look_of)(const Templates&, const std::string&));

/// One line before and after an adjustment, with the prediction and its U.
void add_before_after(const Source&, const Measured&, std::vector<reports::Plot>&);
/// The diagonals before and after, and their plane with exaggerated errors.
void add_diagonals(const Source&, const Measured&, std::vector<reports::Plot>&);
/// The volume of step diagonals, or of an error map, as a wire frame with exaggerated errors.
void add_volume(const Source&, const Measured&, std::vector<reports::Plot>&);
/// Rounds a factor of exaggeration down to 1, 2 or 5 times a power of ten; `v` > 0.
double round_factor(double v);
/// The circle of ball centers with exaggerated residuals, and the residuals over the angle.
void add_circle(const Source&, const Measured&, std::vector<reports::Plot>&);
/// Residuals of two rotary axes as one chain, over the angle of each.
void add_chain(const Source&, const Measured&, std::vector<reports::Plot>&);
/// `path_plot` is a polar plot of a circular test; `add_path` adds it together with the causes,
/// sorted by size.
std::optional<reports::Plot> path_plot(const Source&, const Measured&);
void add_path(const Source&, const Measured&, Blocks&);
/// `rings` is an empty polar plot: the mean is four divisions from the center, and curves are at
/// most three divisions from it. `division_of` is that division for deviations of up to `largest`.
reports::Plot rings(const Source&, std::string title, std::string caption);
double division_of(double largest);
std::string division_text(const Source&, double division);
/// Whether a measurement is a thermal, spindle or length test, which has its own figures.
inline bool is_heat(const Measurement& m) {
  return m.kind == "thermal" || m.kind == "spindle" || m.kind == "lengths";
}
std::optional<reports::Plot> heat_plot(const Source&, const Measured&);
void add_heat(const Source&, const Measured&, Blocks&);

}  // namespace nonio::pages
