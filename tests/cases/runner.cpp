// SPDX-License-Identifier: Apache-2.0
//
// Runs text cases: see README.md. Exit status: 0 all hold, 1 some do not, 2 a file cannot be read.
#include <cmath>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>

#include "case.h"
#include "expression.h"
#include "nonio/sdk/units.h"

namespace {

struct Counts {
  int held = 0, failed = 0, broken = 0;
};

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line.substr(0, line.find('#')));
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

const nonio::Finding* find(const Outcome& out, const std::string& id) {
  for (const auto& f : out.findings)
    if (f.id == id) return &f;
  return nullptr;
}

// NaN holds nothing: the comparison is written so that it fails.
std::string compare(std::optional<double> found, const std::vector<std::string>& words,
                    std::size_t from) {
  if (from < words.size() && words[from] == "absent")
    return !found || std::isnan(*found) ? "" : "expected absent, found " + std::to_string(*found);
  double tolerance = 1e-9;
  std::string text;
  for (std::size_t k = from; k < words.size(); ++k) {
    if (words[k] != "tolerance") {
      text += words[k] + " ";
      continue;
    }
    const auto t = k + 1 < words.size() ? Expression::value(words[k + 1]) : std::nullopt;
    if (!t || k + 2 != words.size()) return "expected a number after tolerance";
    tolerance = *t;
    break;
  }
  const auto wanted = Expression::value(text);
  if (!wanted) return "cannot read the number " + text;
  if (!found || std::isnan(*found)) return "expected " + text + ", found nothing";
  if (std::fabs(*found - *wanted) <= tolerance) return "";
  std::ostringstream why;
  why.precision(12);
  why << "expected " << *wanted << ", found " << *found;
  return why.str();
}

std::optional<double> evidence(const nonio::Finding& f, const std::string& name) {
  for (const auto& n : f.evidence)
    if (n.name == name) return n.value * nonio::unit_of(n.quantity).per_si;
  return std::nullopt;
}

// expect NAME NUMBER [tolerance T] | NAME absent | NAME WORD | [no] finding ID [NAME NUMBER ...]
std::string check(const Outcome& out, const std::vector<std::string>& words) {
  if (words.size() < 3) return "expected: expect NAME NUMBER";
  const bool no = words[1] == "no";
  if (no || words[1] == "finding") {
    if (no && words.size() != 4) return "expected: expect no finding ID";
    const auto* f = find(out, words[no ? 3 : 2]);
    if (no) return f == nullptr ? "" : "expected no finding " + words[3];
    if (f == nullptr) return "expected finding " + words[2] + ", not found";
    if (words.size() == 3) return "";
    if (words[3] == "attention" || words[3] == "info")
      return f->attention == (words[3] == "attention") ? "" : "expected severity " + words[3];
    return compare(evidence(*f, words[3]), words, 4);
  }
  if (const auto it = out.words.find(words[1]); it != out.words.end())
    return it->second == words[2] ? "" : "expected " + words[2] + ", found " + it->second;
  const auto it = out.values.find(words[1]);
  return compare(it == out.values.end() ? std::nullopt : std::optional(it->second), words, 2);
}

bool run_file(const std::string& path, Counts& counts) {
  std::ifstream in(path);
  if (!in) {
    std::cerr << path << ": cannot be opened\n";
    return false;
  }
  Case current;
  std::optional<Outcome> outcome;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto words = words_of(line);
    if (words.empty()) continue;
    std::string complaint;
    if (words[0] == "operation") {
      current = begin_case(words);
      outcome.reset();
    } else if (words[0] == "given") {
      complaint = give(current, words);
      counts.broken += complaint.empty() ? 0 : 1;
      outcome.reset();
    } else if (words[0] == "expect") {
      if (!outcome) outcome = evaluate(current);
      complaint = check(*outcome, words);
      ++(complaint.empty() ? counts.held : counts.failed);
    } else {
      complaint = "expected operation, given or expect, found " + words[0];
      ++counts.broken;
    }
    if (!complaint.empty())
      std::cout << path << ":" << number << ": " << line << "\n    " << complaint << "\n";
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Counts counts;
  bool readable = argc > 1;
  for (int k = 1; k < argc; ++k) readable = run_file(argv[k], counts) && readable;
  std::cout << counts.held << " hold, " << counts.failed << " do not\n";
  if (!readable || counts.broken > 0 || counts.held + counts.failed == 0) return 2;
  return counts.failed == 0 ? 0 : 1;
}
