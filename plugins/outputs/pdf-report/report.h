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

/// What every part of the report is made from.
struct Source : pages::Source {
  const Wording& pictures;  ///< words of the model's pictures
  const Wording& site;      ///< words of the laboratory's pages: quantities, events
};

/// Its template, checked.
Expected<pages::Look> look_of(const Templates&, const std::string& name);

/// Title and status (with what requires action), campaign, machine, instrument.
void add_title(const Source&, Blocks&);
void add_identity(const Source&, Blocks&);
void add_status(const Source&, Blocks&);

/// What analyses of the whole campaign state: rows of a plan, and their findings.
void add_plans(const Source&, Blocks&);
/// Whether advice is printed in a part of its own, block "laboratory".
bool has_laboratory_part(const Source&);
/// What a model states is not a result: it is printed in that part alone.
bool is_for_laboratory(const Source&, const Finding&);
void add_laboratory(const Source&, Blocks&);
void add_findings(const Source&, const Measured&, Blocks&);
/// What controllers' tables have to state; what several of them state alike once, with all their
/// names.
struct TableFinding {
  const Finding* finding;
  std::string outputs;
  bool refused;  ///< no file was written
};
std::vector<TableFinding> table_findings(const Source&);
std::string title_of(const Source&, const TableFinding&);

/// How the models fit: verdict, parameters, the falling error.
void add_models(const Source&, Blocks&);
/// Readings with their model, and what it leaves.
void add_fit(const Source&, const ModelFit&, Blocks&);
/// A page of pictures for each model.
void add_residuals(const Source&, Blocks&);
/// Always the same nine, in the same places, together with their heading on one page.
void add_pictures(const Source&, const ModelFit&, Blocks&);

/// The machine over its campaigns up to this one: a page, if the options request it.
void add_history(const Source&, Blocks&);

void add_tables(const Source&, Blocks&);
void add_notes(const Source&, Blocks&);

/// A finding as the document shows it.
reports::Block note_of(const Source&, const Finding&);

/// The whole document.
reports::Document compose(const Source&);

}  // namespace nonio::pdf_report
