// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "campaign/config/formula_units.h"
#include "campaign/config/keys.h"

/// What the tables of several files have in common. Apart from the rest of the room: `text`,
/// `date` and the like are words that others use too.
namespace nonio::config::declared {

using enum Key::Holds;
using Words = std::string_view;

inline constexpr Words not_negative = "expected a number that is not negative";
inline constexpr Words above_0 = "expected a number above 0";
// Values beyond these are typing errors, or are in another unit.
inline constexpr Words some_um = "expected a number that is not negative, at most 10000 um";
inline constexpr Words some_arcsec = "expected a number that is not negative, at most 36000 arcsec";
inline constexpr Words some_K =
    "expected a number that is not negative, a difference of at most 60 K";
inline constexpr Words an_expansion = "expected um/(m K) from -5 to 200, 11.5 for steel";
inline constexpr Words an_expansion_range =
    "expected a number that is not negative, at most 100 um/(m K)";
inline constexpr double most_um = 1e4, most_arcsec = 36000.0, most_K = 60.0, most_mm = 1e6;
inline constexpr double least_expansion = -5.0, most_expansion = 200.0,
                        most_expansion_range = 100.0;
inline constexpr Words two_numbers =
    "expected two numbers, the smaller one first, none beyond 1000000 in size";
inline constexpr Choice axis_kinds[] = {{"linear"}, {"rotary"}};
inline constexpr Words linear[] = {"linear"}, rotary[] = {"rotary"};
inline constexpr When if_linear{"kind", linear}, if_rotary{"kind", rotary};
inline constexpr Words some_backlash = "expected a number from -10 to 10, or \"none\"";
inline constexpr double most_backlash = 10.0;
inline constexpr Words an_asset =
    "expected up to 100 characters without / and \\, not starting with a point; found \"{}\"";
inline constexpr auto unit_choices = [] {
  std::array<Choice, formula_units.size()> choices{};
  for (std::size_t i = 0; i < choices.size(); ++i)
    choices[i] = {formula_units[i].symbol(), formula_units[i].words};
  return choices;
}();

inline constexpr Key parameter_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of the parameter in the expression.",
     .required = true},
    {.name = "unit",
     .holds = text,
     .help = "Unit of the parameter.",
     .required = true,
     .missing = "expected one of {}",
     .choices = unit_choices},
    {"start", number, "Start value of the search, in the parameter's unit; required with range."},
    {.name = "range",
     .holds = span,
     .help = "Range of the search, two values in the parameter's unit. Without start and range "
             "the parameter must enter linearly and is fitted.",
     .wanted = two_numbers},
};

inline constexpr Key formula_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of the effect, up to 40 of a-z 0-9 -; [model] effects lists it as name:axis.",
     .required = true,
     .wanted = "expected up to 40 of a-z 0-9 -; found \"{}\"",
     .text = {.letters = "a-z0-9-", .longest = 40}},
    {.name = "axis", .holds = text, .help = "The axis of the deviation.", .required = true},
    {.name = "expression",
     .holds = text,
     .help = "The deviation as a formula, \"a*sin(2*_pi*p/P)\".",
     .required = true},
    {.name = "parameters",
     .holds = tables,
     .help = "The parameters of the expression, 12 at most.",
     .required = true,
     .missing = "[{ name = \"a\", unit = \"um\" }], one at least",
     .wanted = "expected 12 parameters at most, found {}",
     .longest_list = 12,
     .keys = parameter_keys},
};

inline constexpr Key run_keys[] = {
    {.name = "analyses",
     .holds = texts,
     .help = "Analyses of the campaign. Default: all that apply, except those on request.",
     .named = Named::analysis},
    {.name = "outputs",
     .holds = texts,
     .help = "Outputs of the campaign. Default: all that apply, except those on request.",
     .named = Named::output},
};

inline constexpr Choice locations[] = {
    {"laboratory"}, {"customer"}, {"laboratoryBranch"}, {"customerBranch"}, {"other"}};
inline constexpr Choice decision_rules[] = {
    {"iso14253-1", "edition 2017: guard band 1.65 u, in between indeterminate"},
    {"iso14253-1:2013", "guard band U, in between indeterminate"},
    {"ilac-g8-simple", "simple acceptance"},
    {"ilac-g8-guarded", "guard band w = U"}};
inline constexpr TextRule language = {.letters = "a-z", .shortest = 2, .longest = 2};
inline constexpr Key languages_key = {
    .name = "languages",
    .holds = texts,
    .help = "One or two languages of the certificate: de, en, es, it, zh. Default: en.",
    .wanted = "expected one or two languages, [\"it\", \"en\"]",
    .text = language,
    .longest_list = 2,
    .distinct = true};

inline constexpr Key template_key = {
    .name = "template",
    .holds = text,
    .help = "Template of the certificate: a file in templates/, without .toml.",
    .otherwise = "certificate",
    .wanted = "expected the name of a file in templates/, without .toml",
    .text = {.letters = "a-z0-9_-"}};

inline constexpr Key location_key = {.name = "location",
                                     .holds = text,
                                     .help = "Place of the calibration.",
                                     .otherwise = "customer",
                                     .choices = locations};

inline constexpr Key procedure_key = {"procedure", text,
                                      "The laboratory's own procedure, in addition to the "
                                      "standards."};

inline constexpr Key title_key = {
    .name = "title",
    .holds = translations,
    .help =
        "Title of the certificate: a text, or texts by language, { it = \"...\", en = \"...\" }.",
    .wanted = "expected a text, or texts by language, { it = \"...\", en = \"...\" }",
    .text = language};

inline constexpr Key decision_rule_key = {
    .name = "decision_rule",
    .holds = text,
    .help = "The decision rule for conformity with a tolerance.",
    .otherwise = "iso14253-1",
    .choices = decision_rules};

inline constexpr Key format_key = {.name = "format",
                                   .holds = whole,
                                   .help = "Version of this format.",
                                   .wanted =
                                       "expected 1, found {}: this file is for another version of "
                                       "nonio",
                                   .least = 1,
                                   .most = 1};

inline constexpr Key required_format() {
  Key key = format_key;
  key.required = true;
  key.missing = "expected format = 1 as the first line";
  return key;
}

inline constexpr Key run_key = {
    .name = "run", .holds = table, .help = "Selected analyses and outputs.", .keys = run_keys};
inline constexpr Key options_key = {"options", options,
                                    "Options of plugins, [options.iso230-2]; `nonio plugin list` "
                                    "lists them."};

}  // namespace nonio::config::declared
