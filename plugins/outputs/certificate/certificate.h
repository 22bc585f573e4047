// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dcc.h"
#include "pages.h"

/// The document for the customer, with the content required by ISO/IEC 17025:2017, 7.8.
namespace nonio::certificate {

using pages::Blocks;
using pages::Source;

/// Sentences about departures of a test from its method, as far as the data show them.
std::vector<std::string> departures_of(const Source&, const pages::Measured&);
/// Conditions of a test, including those that are not stated.
std::string test_parameters(const Source&, const pages::Measured&);

/// Name of the method with edition and k. The name of a standard is omitted if the test did not
/// follow its plan.
std::string method_of(const Source&, const Results::Analysed&);

/// Lowest and highest reading of an influence quantity, in degC, hPa or %; low > high if there are
/// no readings.
struct Range {
  double low, high;
  bool known() const { return low <= high; }
};
struct Conditions {
  Range material, air, pressure, humidity;
};
Conditions conditions_of(const std::vector<Observations>&);

/// Whether the method is only based on a standard, so that the document names the laboratory's
/// procedure (ISO/IEC 17025:2017, 7.2.1).
bool is_by_own_procedure(const Results::Analysed&);
/// Whether the certificate contains the analysis or measurement: it has a value with U > 0.
bool is_printed(const Results::Analysed&);
bool is_printed(const pages::Measured&);

/// Adds a missing full stop to a text of the user, because another sentence follows.
std::string ended(const Source&, std::string text);

/// The title of the manifest, otherwise of the template texts.
std::string title_of(const Source&);

/// The number of the certificate, or the word "draft", in the language of the document.
std::string number_of(const Source&);

/// Keys of all missing items, with their file.
std::vector<std::string> lacks(const OutputInput&);

/// Title or mark of the template that requires an accreditation; empty if there is none.
std::string accredited_claim(const OutputInput&);

Expected<pages::Look> look_of(const Templates&, const std::string& name);

void add_title(const Source&, Blocks&);
void add_amendment(const Source&, Blocks&);
void add_parties(const Source&, Blocks&);
void add_item(const Source&, Blocks&);
void add_method(const Source&, Blocks&);
void add_conditions(const Source&, Blocks&);
void add_conformity(const Source&, Blocks&);
/// Figures with tolerance limits; results before and after an adjustment are in one figure.
void add_overview(const Source&, Blocks&);
void add_opinions(const Source&, Blocks&);
void add_statements(const Source&, Blocks&);
void add_authority(const Source&, Blocks&);
/// Approver, frame of the signature, and code, at the bottom of the first page.
void add_signature(const Source&, Blocks&);

/// Limits that were not compared with a result; empty if there are none.
std::string undecided_text(const Source&);

/// Measurements without printed results; empty if there are none.
std::string not_reported_text(const Source&);

/// Whether a printed test has targets, so that the sign of the directions must be explained.
bool has_directions(const OutputInput&);

/// Instruments whose calibration was not valid on the date of measurement, with the person who
/// approved this and the reason; empty if there are none.
std::string expired_text(const Source&);

/// The replaced certificate and all changes; empty if none is replaced.
std::string amendment_text(const Source&);

/// One source per language.
dcc::About about_of(const std::vector<Source>&, const char* release);

reports::Document compose(const Source&);

}  // namespace nonio::certificate
