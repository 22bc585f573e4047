// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pages.h"

namespace nonio::pdf_report {

using pages::measured;
using pages::plain_number;
using pages::symbol;
using pages::without_gaps;
using reports::typeset;
using reports::Wording;

using pages::Blocks;
using pages::Measured;

struct Source : pages::Source {
  const Wording& pictures;  ///< texts of the model figures
  const Wording& site;      ///< texts of the laboratory's pages: quantities, events
};

Expected<pages::Look> look_of(const Templates&, const std::string& name);

void add_title(const Source&, Blocks&);
void add_identity(const Source&, Blocks&);
void add_status(const Source&, Blocks&);
/// All measurements in one table, if there are at least three; then a new page.
void add_summary(const Source&, Blocks&);

/// Analyses of the whole campaign: rows of a plan, and findings.
void add_plans(const Source&, Blocks&);
/// Whether the block "laboratory" prints all advice.
bool has_laboratory_part(const Source&);
/// Whether a finding is printed in the block "laboratory" only, because a model is not a result.
bool is_for_laboratory(const Source&, const Finding&);
void add_laboratory(const Source&, Blocks&);
void add_findings(const Source&, const Measured&, Blocks&);
/// Finding of a controller plugin; equal findings of several plugins are merged, with all names.
struct TableFinding {
  const Finding* finding;
  std::string outputs;
  bool refused;  ///< no file was written
};
std::vector<TableFinding> table_findings(const Source&);
std::string title_of(const Source&, const TableFinding&);

/// Quality of the models: verdict, parameters, decrease of the error.
void add_models(const Source&, Blocks&);
/// Readings with their model, and the residuals.
void add_fit(const Source&, const ModelFit&, Blocks&);
/// Maps of the errors of parts, in place of the figure of `add_fit`; false if there are no parts.
bool add_part_maps(const Source&, const ModelFit&, Blocks&);
/// One page of figures per model.
void add_residuals(const Source&, Blocks&);
/// Nine figures in fixed positions on one page, with their heading.
void add_pictures(const Source&, const ModelFit&, Blocks&);

/// One page if the option `history` is set.
void add_history(const Source&, Blocks&);

void add_tables(const Source&, Blocks&);
void add_notes(const Source&, Blocks&);

reports::Block note_of(const Source&, const Finding&);

reports::Document compose(const Source&);

}  // namespace nonio::pdf_report
