// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dcc.h"
#include "pages.h"

/// The document that goes to the customer: what ISO/IEC 17025:2017, 7.8 requests.
namespace nonio::certificate {

using pages::Blocks;
using pages::Source;

/// What of a test was other than its method plans, as the program knows it: sentences.
std::vector<std::string> departures_of(const Source&, const pages::Measured&);
/// How a test was made, and what of that is not stated.
std::string test_parameters(const Source&, const pages::Measured&);

/// The name of an analysis as a method, with the edition and k that it used; without that of a
/// standard whose plan of the test was not followed.
std::string method_of(const Source&, const Results::Analysed&);

/// The conditions of a measurement as its readings contain them, degC, hPa, %: lowest and highest.
struct Range {
  double low, high;
  bool known() const { return low <= high; }
};
struct Conditions {
  Range material, air, pressure, humidity;
};
Conditions conditions_of(const std::vector<Observations>&);

/// An analysis whose values a certificate prints.
/// A method of the laboratory that is based on a standard, not the standard's own: the document
/// names the laboratory's procedure (ISO/IEC 17025:2017, 7.2.1).
bool is_by_own_procedure(const Results::Analysed&);
bool is_printed(const Results::Analysed&);
bool is_printed(const pages::Measured&);

/// With a full stop, where a person's text ends without one and another sentence follows.
std::string ended(const Source&, std::string text);

/// The title in the document's language: the laboratory's, or that of the words.
std::string title_of(const Source&);

/// The number, or the word for what has none yet.
std::string number_of(const Source&);

/// Everything that is missing, as keys with their file.
std::vector<std::string> lacks(const OutputInput&);

/// What of the template cannot be had without an accreditation: a title that claims one, a mark.
std::string accredited_claim(const OutputInput&);

Expected<pages::Look> look_of(const Templates&, const std::string& name);

/// The parts, in the language of the source.
void add_title(const Source&, Blocks&);
void add_amendment(const Source&, Blocks&);
void add_parties(const Source&, Blocks&);
void add_item(const Source&, Blocks&);
void add_method(const Source&, Blocks&);
void add_conditions(const Source&, Blocks&);
void add_conformity(const Source&, Blocks&);
/// Pictures with the lines of the limits; before and after an adjustment in one.
void add_overview(const Source&, Blocks&);
void add_opinions(const Source&, Blocks&);
void add_statements(const Source&, Blocks&);
/// How to verify it.
void add_authority(const Source&, Blocks&);
/// Who released it, the frame of the signature and the code: at the foot of the first page.
void add_signature(const Source&, Blocks&);

/// Limits that no result was compared with; empty if there are none.
std::string undecided_text(const Source&);

/// Measurements of the campaign of which nothing is printed; empty if there are none.
std::string not_reported_text(const Source&);

/// Directions of approach and their signs mean something: a test over targets is printed.
bool has_directions(const OutputInput&);

/// Instruments whose calibration was not valid on the day of the measurement, and who has approved
/// the certificate in spite of it, for which reason; empty if there are none.
std::string expired_text(const Source&);

/// What it states about the certificate that it replaces, with every change; empty if there is
/// none.
std::string amendment_text(const Source&);

/// What the DCC states in words; a source for each language.
dcc::About about_of(const std::vector<Source>&, const char* release);

/// The document in one language.
reports::Document compose(const Source&);

}  // namespace nonio::certificate
