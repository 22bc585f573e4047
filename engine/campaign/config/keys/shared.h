// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "campaign/config/checks.h"
#include "campaign/config/formula_units.h"

/// A namespace of their own, because words such as `text` and `date` are used elsewhere too.
namespace nonio::config::declared {

using Words = std::string_view;

inline constexpr Unit mm{"mm", 1e-3}, um{"um", 1e-6}, deg{"deg", 1.0 / deg_per_rad},
    arcsec{"arcsec", 1.0 / arcsec_per_rad}, urad{"urad", 1e-6}, K{"K"}, seconds{"s"},
    minutes{"min", 60.0}, um_per_m_K{"um/(m K)", 1e-6}, mm_per_min{"mm/min", 1e-3 / 60.0},
    deg_per_min{"deg/min", 1.0 / deg_per_rad / 60.0}, um_per_m{"um/m", 1e-6},
    mm_or_deg{"mm or deg"}, MB{"MB"};
inline constexpr Range not_negative = from(0.0, "expected a number that is not negative");
inline constexpr Range above_0 = above(0.0, "expected a number above 0");
inline constexpr Range a_tolerance = above(0.0, "expected a tolerance above 0");
// Beyond these limits a value is a typing error or in another unit.
inline constexpr Range some_um =
    within(0.0, 1e4, "expected a number that is not negative, at most 10000 um");
inline constexpr Range some_arcsec =
    within(0.0, 36000.0, "expected a number that is not negative, at most 36000 arcsec");
inline constexpr Range some_K =
    within(0.0, 60.0, "expected a number that is not negative, a difference of at most 60 K");
inline constexpr Range an_expansion =
    within(-5.0, 200.0, "expected um/(m K) from -5 to 200, 11.5 for steel");
inline constexpr Range an_expansion_range =
    within(0.0, 100.0, "expected a number that is not negative, at most 100 um/(m K)");
inline constexpr Range two_numbers =
    within(-1e6, 1e6, "expected two numbers, the smaller one first, none beyond 1000000 in size");
inline constexpr Range some_backlash =
    within(-10.0, 10.0, "expected a number from -10 to 10, or \"none\"");
inline constexpr Choice axis_kinds[] = {choice(false, "linear"), choice(true, "rotary")};
inline constexpr Words linear[] = {"linear"}, rotary[] = {"rotary"};
inline constexpr auto if_linear = only({"kind", linear}), if_rotary = only({"kind", rotary});
inline constexpr auto an_asset = spelled(
    asset_rule,
    "expected up to 100 characters without / and \\, not starting with a point; found \"{}\"");
inline constexpr auto unit_choices = [] {
  std::array<Choice, formula_units.size()> choices{};
  for (std::size_t i = 0; i < choices.size(); ++i)
    choices[i] =
        choice(formula_units[i].quantity, formula_units[i].symbol(), formula_units[i].words);
  return choices;
}();

inline constexpr Key parameter_keys[] = {
    {"name", into<&Formula::Parameter::name>, "Name of the parameter in the expression.", required},
    {"unit", into<&Formula::Parameter::quantity>, "Unit of the parameter.",
     missing("expected one of {}"), unit_choices},
    {"start", into<&Formula::Parameter::start>,
     "Start value of the search, in the parameter's unit; required with range."},
    {"range", into<&Formula::Parameter::range>,
     "Range of the search, two values in the parameter's unit. Without start and range the "
     "parameter must enter linearly and is fitted.",
     wanted(two_numbers.wanted)},
};

inline constexpr Key formula_keys[] = {
    {"name", into<&Formula::name>,
     "Name of the effect, up to 40 of a-z 0-9 -; [model] effects lists it as name:axis.", required,
     spelled({.letters = "a-z0-9-", .longest = 40},
             "expected up to 40 of a-z 0-9 -; found \"{}\"")},
    {"axis", into<&Formula::axis>, "The axis of the deviation.", required},
    {"expression", into<&Formula::expression>, "The deviation as a formula, \"a*sin(2*_pi*p/P)\".",
     required},
    {"parameters", checked<check_parameter, &Formula::parameters>,
     "The parameters of the expression, 12 at most.",
     missing("[{ name = \"a\", unit = \"um\" }], one at least"),
     wanted("expected 12 parameters at most, found {}"), longest(12), parameter_keys},
};

inline constexpr Key run_keys[] = {
    {"analyses", into<&RunChoice::analyses>,
     "Analyses of the campaign. Default: all that apply, except those on request.",
     Named::analysis},
    {"outputs", into<&RunChoice::outputs>,
     "Outputs of the campaign. Default: all that apply, except those on request.", Named::output},
};

inline constexpr Choice locations[] = {
    {"laboratory"}, {"customer"}, {"laboratoryBranch"}, {"customerBranch"}, {"other"}};
inline constexpr Choice decision_rules[] = {
    {"iso14253-1", "edition 2017: guard band 1.65 u, in between indeterminate"},
    {"iso14253-1:2013", "guard band U, in between indeterminate"},
    {"ilac-g8-simple", "simple acceptance"},
    {"ilac-g8-guarded", "guard band w = U"}};
inline constexpr TextRule language = {.letters = "a-z", .shortest = 2, .longest = 2};
/// `to`: path of the member that contains the texts.
template <auto... to>
inline constexpr Key certificate_texts[] = {
    {"languages", into<to..., &CertificateTexts::languages>,
     "One or two languages of the certificate: de, en, es, it, zh. Default: en.",
     spelled(language, "expected one or two languages, [\"it\", \"en\"]"), longest(2), distinct},
    {"template", into<to..., &CertificateTexts::form>,
     "Template of the certificate: a file in templates/, without .toml.", otherwise("certificate"),
     spelled({.letters = "a-z0-9_-"}, "expected the name of a file in templates/, without .toml")},
    {"location", into<to..., &CertificateTexts::location>, "Place of the calibration.",
     otherwise("customer"), locations},
    {"procedure", into<to..., &CertificateTexts::procedure>,
     "The laboratory's own procedure, in addition to the standards."},
    {"title", into<to..., &CertificateTexts::title>,
     "Title of the certificate: a text, or texts by language, { it = \"...\", en = \"...\" }.",
     spelled(language, "expected a text, or texts by language, { it = \"...\", en = \"...\" }")},
    {"decision_rule", into<to..., &CertificateTexts::decision_rule>,
     "The decision rule for conformity with a tolerance.", otherwise("iso14253-1"), decision_rules},
};

inline constexpr Range this_format =
    within(1, 1, "expected 1, found {}: this file is for another version of nonio");
inline constexpr Key format_key{"format", whole, "Version of this format.", this_format};
inline constexpr Key required_format{"format", whole, "Version of this format.", this_format,
                                     missing("expected format = 1 as the first line")};
template <class T>
inline constexpr Key run_key{"run", nested<&T::run>, "Selected analyses and outputs.", run_keys};
template <class T>
inline constexpr Key options_key{
    "options", by<read_options, options, &T::options>,
    "Options of plugins, [options.iso230-2]; `nonio plugin list iso230-2` lists them."};

}  // namespace nonio::config::declared
