// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "look.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/plugin.h"

/// What the documents about a campaign share: tables and figures of a measurement. Compiled into
/// each plugin. Blocks are of one language.
namespace nonio::pages {

/// What a document is made from.
struct Source {
  const OutputInput& in;
  const Look& look;
  const reports::Wording& words;
  const reports::Fonts& fonts;
  /// A certificate: only what has an uncertainty, nothing that explains.
  bool certificate = false;

  const std::string& language() const { return words.language(); }
};

using Blocks = std::vector<reports::Block>;

/// One measurement with all that is known of it.
struct Measured {
  const Measurement& measurement;
  const Observations& observations;
  bool rotary = false;
  std::vector<const Results::Analysed*> analyses;
  std::vector<const Finding*> findings;  ///< each id once, warnings first
};
std::vector<Measured> measured(const OutputInput&);

/// "A+" as the standards print it: "A↑".
std::string symbol(std::string_view name);

/// "A" of "iso-1988:A", a value of a rule.
std::string without_rule(const std::string& name);
/// What a value is, in words; of one that names another measurement or an axis ("distance_C") with
/// its name. Empty where there is no word.
std::string meaning_of(const Source& source, const std::string& name);

/// A given number, tolerance or uncertainty: as short as it is, "20" and not "20.00".
std::string plain_number(const Source&, double si, Quantity);

/// U of the instrument's certificate: "0.1 µm + 0.5 µm/m · L".
std::string instrument_U(const Source&);

/// Parts of a line that are not known leave no gap: "worn-screw · " becomes "worn-screw".
std::string without_gaps(std::string line);

/// Its readings are runs over one position: of an axis, or along a diagonal.
inline bool over_one_position(const Measurement& m) {
  return m.kind == "axis" || m.kind == "straightness" || m.kind == "angle" || m.kind == "diagonal";
}

std::string heading_of(const Source&, const Measured&);
/// How the test was made, as the readings show it.
std::string test_of(const Source&, const Measured&);
/// Where the targets lie: positions of the axis, of a diagonal the distance from its begin.
std::vector<double> along_line(const Measured&);
/// Without the name of a standard whose plan of the test was not followed.
std::string analysis_title(const Source&, const Results::Analysed&);
/// Whether the test was made as the standard plans it, as the findings state. Of an axis that the
/// standard requires measured in two tests (the whole travel, and a part of it more often) the
/// other one may belong to another measurement.
bool follows_plan(const OutputInput&, const Results::Analysed&);
const Conformity* conformity_of(const OutputInput&, const Results::Analysed&,
                                const std::string& name);
std::string decision_text(const Source&, Decision);
/// Limits of the manifest without a result to compare: axes that were not measured, results that a
/// test does not give. A sentence each.
std::vector<std::string> undecided(const Source&);
/// The rule by which is decided, in words, with its risk.
std::string rule_text(const Source&);

void add_results(const Source&, const Measured&, Blocks&);
void add_targets(const Source&, const Measured&, Blocks&);
void add_plots(const Source&, const Measured&, Blocks&);
/// The one picture that states most of a measurement: its readings by run, circle or volume.
std::optional<reports::Plot> readings_plot(const Source&, const Measured&);
/// "U (k = 2)": the heading of expanded uncertainties that have one coverage factor.
std::string U_heading(const Source&, double k);
/// The results for which the laboratory's smallest uncertainty (CMC) replaces that of the budget;
/// empty if there are none.
std::string cmc_text(const Source&, const Results::Analysed&);
/// What its uncertainties are made of, from the budget that results.json has too.
void add_budget(const Source&, const Measured&, Blocks&);

/// Checks the texts of manifest and site before they become parts of sentences: an error names the
/// key, so that the host can report its line.
Expected<void> check_texts(const Campaign&, const reports::Fonts&);

/// What is wrong with templates/<name>*.toml, and with the words of every language that has
/// words/<language>/<name>.toml, against English: keys, places in braces, letters that the fonts do
/// not have.
std::vector<Error> check_templates(const Templates&, const std::string& name,
                                   Expected<Look> (*look_of)(const Templates&, const std::string&));

/// One line before and after an adjustment, with what was predicted and its U.
void add_before_after(const Source&, const Measured&, std::vector<reports::Plot>&);
/// Diagonals before and after, and their plane with its errors exaggerated.
void add_diagonals(const Source&, const Measured&, std::vector<reports::Plot>&);
/// The volume of step diagonals, or of a map, as a box of wire, its errors exaggerated.
void add_volume(const Source&, const Measured&, std::vector<reports::Plot>&);
/// How much larger errors are drawn: 1, 2 or 5 times a power of ten, not above `v` > 0.
double round_factor(double v);
/// The circle of ball centres with exaggerated residuals, and the residuals over the angle.
void add_circle(const Source&, const Measured&, std::vector<reports::Plot>&);
/// The residuals of two rotary axes as one chain, over the angle of each.
void add_chain(const Source&, const Measured&, std::vector<reports::Plot>&);
/// The path of a circular test over rings, and next to it the causes by their size.
std::optional<reports::Plot> path_plot(const Source&, const Measured&);
void add_path(const Source&, const Measured&, Blocks&);
/// Rings for a polar picture: the mean is four divisions from the middle, what is drawn at most three
/// from it; and that division, for deviations of up to `largest`.
reports::Plot rings(const Source&, std::string title, std::string caption);
double division_of(double largest);
std::string division_text(const Source&, double division);
/// Thermal tests, spindles and lengths have pictures of their own: changes over time, error motions
/// over rings, errors between their limits.
inline bool is_heat(const Measurement& m) {
  return m.kind == "thermal" || m.kind == "spindle" || m.kind == "lengths";
}
std::optional<reports::Plot> heat_plot(const Source&, const Measured&);
void add_heat(const Source&, const Measured&, Blocks&);

}  // namespace nonio::pages
