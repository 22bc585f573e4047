// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "look.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/plugin.h"

namespace nonio::pdf_report {

using reports::typeset;
using reports::Wording;

/// What every part of the report is made from.
struct Source {
  const OutputInput& in;
  const Look& look;
  const Wording& words;
  const Wording& pictures;  ///< words of the model's pictures
  const reports::Fonts& fonts;

  const std::string& language() const { return words.language(); }
};

using Blocks = std::vector<reports::Block>;

/// One measurement with all that is known of it.
struct Measured {
  const Measurement& measurement;
  const Observations& observations;
  bool rotary = false;
  std::vector<const Results::Analysed*> analyses;
  std::vector<const Finding*> findings;  ///< each id once, what needs attention first
};
std::vector<Measured> measured(const Source&);

/// "A+" as the standards print it: "A↑".
std::string symbol(std::string_view name);

/// A given number, tolerance or uncertainty: as short as it is, "20" and not "20.00".
std::string plain_number(const Source&, double si, Quantity);

/// Title and status (with what needs attention), campaign, machine, instrument.
void add_title(const Source&, Blocks&);
void add_identity(const Source&, Blocks&);
void add_status(const Source&, Blocks&);

/// Its readings are runs over one position: of an axis, or along a diagonal.
inline bool over_one_position(const Measurement& m) {
  return m.kind == "axis" || m.kind == "straightness" || m.kind == "angle" || m.kind == "diagonal";
}
void add_results(const Source&, const Measured&, Blocks&);
/// What analyses of the whole campaign say: rows of a plan, and their findings.
void add_plans(const Source&, Blocks&);
void add_targets(const Source&, const Measured&, Blocks&);
void add_plots(const Source&, const Measured&, Blocks&);
void add_findings(const Source&, const Measured&, Blocks&);
/// Diagonals before and after, and their plane with its errors exaggerated.
void add_diagonals(const Source&, const Measured&, std::vector<reports::Plot>&);
/// The volume of step diagonals as a box of wire, its errors exaggerated.
void add_volume(const Source&, const Measured&, std::vector<reports::Plot>&);
/// How much larger errors are drawn: 1, 2 or 5 times a power of ten, not above `v` > 0.
double round_factor(double v);
/// The circle of ball centres with exaggerated residuals, and the residuals over the angle.
void add_circle(const Source&, const Measured&, std::vector<reports::Plot>&);

/// What controllers' tables have to say; what several of them say alike once, with all their names.
struct TableFinding {
  const Finding* finding;
  std::string outputs;
  bool refused;  ///< no file was written
};
std::vector<TableFinding> table_findings(const Source&);
std::string title_of(const Source&, const TableFinding&);

/// How the models fit: verdict, parameters, the falling error.
void add_models(const Source&, Blocks&);
/// A page of pictures for each model.
void add_residuals(const Source&, Blocks&);
/// Always the same nine, in the same places, together with their heading on one page.
void add_pictures(const Source&, const ModelFit&, Blocks&);

void add_tables(const Source&, Blocks&);
void add_notes(const Source&, Blocks&);

/// A finding as the document shows it.
reports::Block note_of(const Source&, const Finding&);

/// The whole document.
reports::Document compose(const Source&);

}  // namespace nonio::pdf_report
